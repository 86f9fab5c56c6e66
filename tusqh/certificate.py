"""Make the topology certificate of a mesh, and check it from the mesh file alone.

A certificate holds claims about the mesh and about the fractions from which it was made.  The check
recomputes both by the functions that made them, and compares.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pandas as pd

from tusqh import __version__
from tusqh.antialias.cells import CellSet, CellSets
from tusqh.errors import MeshError
from tusqh.hashing import hash_file
from tusqh.local_topology.feature_cells import repeat_choice
from tusqh.local_topology.move import changes_of
from tusqh.local_topology.wishes import Wish
from tusqh.meshes.checks import Check
from tusqh.meshes.export import read_vtu
from tusqh.meshes.measure import Measured
from tusqh.meshes.volume_mesh import GRID_CELL, INNER_CELL, VolumeMesh
from tusqh.sampling.io import load_fractions
from tusqh.settings.policy import Policy
from tusqh.threshold.selection import Selection
from tusqh.topology.betti_numbers import BettiNumbers

#: Name of the certificate in the folder of its mesh.
FILE_NAME = "certificate.json"

#: Names of the parts of a claim in tables.
_TITLES = {
    "mesh": "SHA-256 of the mesh",
    "fractions": "SHA-256 of the fractions",
    "raw": "raw prediction from the fractions",
    "effective": "effective prediction from the fractions",
    "euler": "Betti numbers by Euler characteristic",
    "boundary": "Betti numbers by boundary",
    "predicted": "predicted Betti numbers",
    "contacts": "contacts from the fractions",
    "features": "removed and filled features from the fractions",
    "changes": "cells that differ from the base, from the fractions",
    "cells": "cells of the mesh that the fractions do not give, or lack",
    "checks": "checks of the mesh",
    "holds": "holds",
}


def make_certificate(
    selection: Selection, cells: CellSet, mesh_file: Path, fractions_file: Path, *, name: str
) -> dict[str, Any]:
    """Return the certificate of a mesh, measured on the file as it was written.

    Parameters
    ----------
    selection
        The threshold and the reason for its choice.
    cells
        The cells of the mesh, with decisions, bridges and removed and filled features.
    mesh_file, fractions_file
        The mesh and the fractions it was made of, in one folder.
    name
        The model.

    Raises
    ------
    MeshError
        The mesh does not have the predicted topology, or a check fails; no certificate is made.
    """
    measured = read_vtu(mesh_file, name=name).measurement
    files = {
        "mesh": {"file": mesh_file.name, "sha256": hash_file(mesh_file)},
        "fractions": {"file": fractions_file.name, "sha256": hash_file(fractions_file)},
    }
    return certify(selection, cells, measured, files, name=name)


def certify(
    selection: Selection,
    cells: CellSet,
    measured: Measured,
    files: Mapping[str, Mapping[str, Any]],
    *,
    name: str,
) -> dict[str, Any]:
    """Return the certificate of a mesh that was measured as it was written.

    Parameters
    ----------
    selection, cells
        See `make_certificate`.
    measured
        The measurement.
    files
        Name and digest of the `mesh` and the `fractions`, and the digests of their pieces.
    name
        The model.

    Raises
    ------
    MeshError
        The mesh does not have the predicted topology, or a check fails; no certificate is made.
    """
    if cells.predicted != selection.predicted or not _is_as_predicted(measured, cells.predicted):
        failed = "; ".join(check.name for check in measured.failed)
        raise MeshError(
            f"measured Betti numbers {measured.by_euler} and {measured.by_boundary}, "
            f"failed checks: {failed or 'none'}",
            where=name,
            expected=f"the predicted Betti numbers {selection.predicted}, and no failed check",
            remedy="this is a fault of tusqh: please report it with fractions.npz",
        )
    of_mesh, of_cells = _claim_of_mesh(measured), claim_of_cells(cells, selection.raw)
    chosen = selection.to_dict()
    certificate = {
        "certificate": 3,
        "model": name,
        "tusqh": __version__,
        "mesh": files["mesh"],
        "fractions": files["fractions"],
        "selection": {key: chosen[key] for key in chosen if key not in ("raw", "predicted")},
        "predicted": {"raw": of_cells["raw"], "effective": of_cells["effective"]},
        "measured": {"euler": of_mesh["euler"], "boundary": of_mesh["boundary"]},
        "contacts": of_cells["contacts"],
        "bridges": _to_records(cells.bridge_table),
        "features": of_cells["features"],
        "changes": of_cells["changes"],
        "checks": of_mesh["checks"],
        "holds": True,
    }
    jsonschema.validate(certificate, schema())
    return certificate


def check_certificate(path: Path, mesh_file: Path, mesh: VolumeMesh) -> list[Check]:
    """Return the checks of a certificate's claims, recomputed from mesh and fractions.

    Parameters
    ----------
    path
        The certificate.
    mesh_file
        The mesh it should belong to.
    mesh
        That mesh, as read.

    Raises
    ------
    MeshError
        The certificate cannot be read or does not follow the schema.
    """
    stored = read_certificate(path)
    recomputed = claims_of_mesh(stored, mesh.measurement) | {"mesh": hash_file(mesh_file)}
    fractions_file = path.parent / stored["fractions"]["file"]
    if fractions_file.is_file():
        chosen = stored["selection"]
        cell_sets = CellSets(load_fractions(fractions_file), Policy.from_dict(chosen["policy"]))
        raw = cell_sets.topology.betti_at(chosen["threshold"])
        wishes = [Wish(**wish) for wish in chosen["features"]]
        cells = repeat_choice(cell_sets, chosen["base"], wishes).at(chosen["threshold"])
        recomputed |= {
            "fractions": hash_file(fractions_file),
            **claim_of_cells(cells, raw),
            "cells": _count_other_cells(mesh, cells),
        }
    return compare_claims(stored, recomputed)


def claims_of_mesh(stored: Mapping[str, Any], measured: Measured) -> dict[str, Any]:
    """Return what a certificate claims about its mesh, recomputed.

    Parameters
    ----------
    stored
        The certificate.
    measured
        The measurement of the mesh.
    """
    claimed = BettiNumbers(*stored["predicted"]["effective"])
    return {
        "mesh": "",
        **_claim_of_mesh(measured),
        "predicted": list(measured.by_euler),
        "holds": _is_as_predicted(measured, claimed),
    }


def compare_claims(stored: Mapping[str, Any], recomputed: Mapping[str, Any]) -> list[Check]:
    """Return the checks that recomputed claims equal those of a certificate.

    Parameters
    ----------
    stored
        The certificate.
    recomputed
        The claims by name.
    """
    claimed = _claims_in(stored)
    return [_compare(key, found, claimed[key]) for key, found in recomputed.items()]


def schema() -> dict[str, Any]:
    """Return the JSON schema of certificates."""
    text = resources.files("tusqh").joinpath("certificate.schema.json").read_text("utf-8")
    return dict(json.loads(text))


def read_predicted(path: Path) -> BettiNumbers:
    """Return the predicted Betti numbers that a certificate states.

    Parameters
    ----------
    path
        The certificate.

    Raises
    ------
    MeshError
        The certificate cannot be read or does not follow the schema.
    """
    return BettiNumbers(*read_certificate(path)["predicted"]["effective"])


def _is_as_predicted(measured: Measured, predicted: BettiNumbers) -> bool:
    return measured.is_sound and measured.has_topology(predicted)


def _claim_of_mesh(measured: Measured) -> dict[str, Any]:
    """Return the claims about the mesh alone."""
    return {
        "euler": list(measured.by_euler),
        "boundary": list(measured.by_boundary),
        "checks": [
            {
                "id": check.id,
                "name": check.name,
                "found": str(check.found),
                "required": check.required,
                "holds": bool(check.holds),
            }
            for check in measured.checks
        ],
    }


def claim_of_cells(cells: CellSet, raw: BettiNumbers) -> dict[str, Any]:
    """Return the claims about the fractions at the threshold, before meshing.

    Parameters
    ----------
    cells
        The cells with their decisions.
    raw
        Betti numbers of the filtration.
    """
    return {
        "raw": list(raw),
        "effective": list(cells.predicted),
        "contacts": {
            "decided": cells.n_contacts,
            "overruled": cells.n_overruled,
        },
        "features": _to_records(cells.features),
        "changes": _to_records(changes_of(cells)),
    }


def _count_other_cells(mesh: VolumeMesh, cells: CellSet) -> int:
    """Return the number of grid cells kept either in the mesh or by its fractions, not by both."""
    is_body = np.isin(mesh.kind, (GRID_CELL, INNER_CELL))
    return len(np.setxor1d(mesh.grid_cell[is_body], np.flatnonzero(cells.kept)))


def _claims_in(stored: Mapping[str, Any]) -> dict[str, Any]:
    """Return the claims of a certificate under the names of the recomputed ones."""
    return {
        **{key: stored[key]["sha256"] for key in ("mesh", "fractions")},
        **stored["predicted"],
        **stored["measured"],
        "predicted": stored["predicted"]["effective"],
        "cells": 0,
        **{key: stored[key] for key in ("contacts", "features", "changes", "checks", "holds")},
    }


def _compare(key: str, found: Any, claimed: Any) -> Check:
    """Return the check of one claim; it shortens digests and shows tables by their row counts."""
    is_digest = key in ("mesh", "fractions")
    is_table = key in ("checks", "features", "changes")
    shown = [
        value[:12] if is_digest else f"{len(value)} rows" if is_table else value
        for value in (found, claimed)
    ]
    return Check(
        id=f"certificate_{key}",
        name=f"certificate: {_TITLES[key]}",
        found=shown[0],
        required=str(shown[1]),
        holds=found == claimed,
    )


def read_certificate(path: Path) -> dict[str, Any]:
    """Return a certificate.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    MeshError
        It cannot be read or does not follow the schema.
    """
    try:
        stored = json.loads(path.read_text("utf-8"))
        jsonschema.validate(stored, schema())
    except (OSError, ValueError, jsonschema.ValidationError) as reason:
        text = reason.message if isinstance(reason, jsonschema.ValidationError) else str(reason)
        raise MeshError(
            f"is not a valid certificate: {text}",
            where=str(path),
            expected="a file that the mesh step wrote, unchanged",
            remedy="make the mesh again, or check the mesh in another folder without certificate",
        ) from reason
    return dict(stored)


def _to_records(table: pd.DataFrame) -> list[dict[str, Any]]:
    """Return a table as plain values, for JSON."""
    return list(json.loads(table.to_json(orient="records", double_precision=15)))
