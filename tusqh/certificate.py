"""The topology certificate beside every mesh, and its check from the mesh file alone."""

from __future__ import annotations

import json
from importlib import resources
from pathlib import Path
from typing import Any

import jsonschema
import pandas as pd

from tusqh import __version__
from tusqh.antialias.cells import CellSet, CellSets
from tusqh.errors import MeshError
from tusqh.hashing import hash_file
from tusqh.meshes.checks import Check
from tusqh.meshes.export import read_vtu
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.sampling.io import load_fractions
from tusqh.settings.policy import Policy
from tusqh.threshold.select import Selection
from tusqh.topology.betti_numbers import BettiNumbers
from tusqh.topology.curves import betti_curves
from tusqh.topology.persistence import betti_at

#: Name of the certificate in the folder of its mesh.
FILE_NAME = "certificate.json"


def make_certificate(
    selection: Selection, cells: CellSet, mesh_file: Path, fractions_file: Path, *, name: str
) -> dict[str, Any]:
    """Return the certificate of a mesh, measured on the file as it was written.

    Parameters
    ----------
    selection
        The threshold and why it was chosen.
    cells
        The cells of the mesh, with decisions, bridges and dropped features.
    mesh_file, fractions_file
        The mesh and the fractions it was made of, in one folder.
    name
        The model.

    Raises
    ------
    MeshError
        The mesh does not have the predicted topology, or a check fails: no certificate then.
    """
    mesh = read_vtu(mesh_file, name=name)
    measured = mesh.measurement
    checks, by_euler, by_boundary = measured.checks, measured.by_euler, measured.by_boundary
    holds = measured.is_sound and by_euler == by_boundary == cells.predicted == selection.predicted
    if not holds:
        failed = "; ".join(check.name for check in measured.failed)
        raise MeshError(
            f"measured Betti numbers {by_euler} and {by_boundary}, "
            f"failed checks: {failed or 'none'}",
            where=name,
            expected=f"the predicted Betti numbers {selection.predicted}, and no failed check",
            remedy="this is a fault of tusqh: please report it with fractions.npz",
        )
    chosen = {
        key: getattr(selection, key)
        for key in (
            *("wanted", "threshold", "lower", "upper", "margin", "cell_margin", "unexamined"),
            *("reason", "without_features", "policy"),
        )
    }
    certificate = {
        "certificate": 1,
        "model": name,
        "tusqh": __version__,
        "mesh": _digest(mesh_file),
        "fractions": _digest(fractions_file),
        "selection": chosen,
        "predicted": {"raw": list(selection.raw), "effective": list(cells.predicted)},
        "measured": {"euler": list(by_euler), "boundary": list(by_boundary)},
        "pinches": {
            "clusters": cells.decisions.n_clusters,
            "overruled_clusters": cells.decisions.clusters_overruled,
            "overruled_pinches": cells.decisions.pinches_overruled,
        },
        "bridges": _rows(cells.bridge_table),
        "features": _rows(cells.features),
        "checks": [
            {"name": c.name, "found": str(c.found), "required": c.required, "holds": bool(c.holds)}
            for c in checks
        ],
        "holds": holds,
    }
    jsonschema.validate(certificate, schema())
    return certificate


def check_certificate(path: Path, mesh_file: Path, mesh: VolumeMesh) -> list[Check]:
    """Return what a certificate claims, recomputed from the mesh and, if there, the fractions.

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
    claim = _read(path)
    measured = claim["measured"]
    checks = [
        _same_digest("certificate: SHA-256 of the mesh", mesh_file, claim["mesh"]["sha256"]),
        _same(
            "certificate: Betti numbers by Euler characteristic",
            list(mesh.measurement.by_euler),
            measured["euler"],
        ),
        _same(
            "certificate: Betti numbers by boundary",
            list(mesh.measurement.by_boundary),
            measured["boundary"],
        ),
        _same(
            "certificate: predicted Betti numbers",
            claim["predicted"]["effective"],
            measured["euler"],
        ),
        _same("certificate: number of checks", len(mesh.measurement.checks), len(claim["checks"])),
        _same(
            "certificate: failed checks",
            [check.name for check in mesh.measurement.failed],
            [check["name"] for check in claim["checks"] if not check["holds"]],
        ),
        _same("certificate: holds", claim["holds"], True),
    ]
    fractions_file = path.parent / claim["fractions"]["file"]
    if not fractions_file.is_file():
        return checks
    fractions = load_fractions(fractions_file)
    threshold = claim["selection"]["threshold"]
    policy = Policy.from_dict(claim["selection"]["policy"])
    raw = betti_at(betti_curves(fractions.values), threshold)
    effective = CellSets(fractions, policy).at(threshold).predicted
    digest = claim["fractions"]["sha256"]
    return [
        *checks,
        _same_digest("certificate: SHA-256 of the fractions", fractions_file, digest),
        _same(
            "certificate: raw prediction from the fractions", list(raw), claim["predicted"]["raw"]
        ),
        _same(
            "certificate: effective prediction from the fractions",
            list(effective),
            claim["predicted"]["effective"],
        ),
    ]


def schema() -> dict[str, Any]:
    """Return the JSON schema of certificates."""
    text = resources.files("tusqh").joinpath("certificate.schema.json").read_text("utf-8")
    return dict(json.loads(text))


def read_predicted(path: Path) -> BettiNumbers:
    """Return the Betti numbers that a certificate says were predicted."""
    return BettiNumbers(*_read(path)["predicted"]["effective"])


def _read(path: Path) -> dict[str, Any]:
    try:
        claim = json.loads(path.read_text("utf-8"))
        jsonschema.validate(claim, schema())
    except (OSError, ValueError, jsonschema.ValidationError) as reason:
        text = reason.message if isinstance(reason, jsonschema.ValidationError) else str(reason)
        raise MeshError(
            f"is no valid certificate: {text}",
            where=str(path),
            expected="a file that the mesh step wrote, untouched",
            remedy="make the mesh again, or check the mesh in another folder without certificate",
        ) from reason
    return dict(claim)


def _digest(path: Path) -> dict[str, str]:
    return {"file": path.name, "sha256": hash_file(path)}


def _rows(table: pd.DataFrame) -> list[dict[str, Any]]:
    """Return a table as plain values, for JSON."""
    return list(json.loads(table.to_json(orient="records", double_precision=15)))


def _same(name: str, found: object, required: object) -> Check:
    return Check(name, name, found, str(required), found == required)


def _same_digest(name: str, path: Path, required: str) -> Check:
    """Compare whole digests, and show as much as people do."""
    found = hash_file(path)
    return Check(name, name, found[:12], required[:12], found == required)
