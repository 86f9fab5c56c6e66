"""Recompute a certificate's statements about the geometry from the files in its folder."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import Resolved
from tusqh.certificate import read_certificate
from tusqh.files import path_of
from tusqh.geometry.canonical import load_geometry
from tusqh.local_topology.feature_cells import repeat_choice
from tusqh.local_topology.wishes import Wish
from tusqh.meshes.checks import Check
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.pipeline.original import Original, to_warnings
from tusqh.sampling.doubled_grid import RESOLUTION
from tusqh.sampling.fractions import VolumeFractions
from tusqh.sampling.io import load_fractions
from tusqh.settings.policy import Policy

_RECORDED = "as recorded by the certificate: {} is missing from its folder"


def recheck(path: Path, mesh: VolumeMesh) -> list[Check]:
    """Return checks of a certificate's statements about the geometry, and the warnings.

    The grid is placed again, the geometry is sampled again, and the mesh is compared with it again.
    If geometry, fractions or settings are missing, the warnings are those that the certificate
    records, and each of them says so.

    Parameters
    ----------
    path
        The certificate.
    mesh
        The mesh to which it belongs.

    Raises
    ------
    MeshError
        The certificate cannot be read.
    """
    stored = read_certificate(path)
    files = [path_of("geometry", path.parent), path.parent / stored["fractions"]["file"]]
    missing = [file.name for file in files if not file.is_file()]
    if missing or "settings" not in stored:
        return _recorded(stored, " and ".join(missing) or "its settings")
    original = Original.from_dict(load_geometry(files[0]), stored["settings"])
    fractions = load_fractions(files[1])
    sampled = original.sample()
    checks = [_fractions(fractions, sampled, original.sampling.tolerance)]
    if fractions.placement is not None or "placement" in stored:
        checks.append(_equal("placement", "grid", _placement(sampled), stored.get("placement")))
    chosen = stored["selection"]
    cells = repeat_choice(
        CellSets(fractions, Policy.from_dict(chosen["policy"])),
        chosen["base"],
        [Wish(**wish) for wish in chosen["features"]],
    )
    resolved = Resolved(mesh, cells.at(chosen["threshold"]))
    comparison = original.compare(resolved, fractions, original.reference(fractions))
    warnings = to_warnings(comparison)
    return [*checks, _equal("warnings", "warnings", warnings, stored["warnings"]), *comparison]


def _recorded(stored: dict[str, Any], missing: str) -> list[Check]:
    """Return the recorded warnings of a certificate."""
    return [
        Check(
            id=warning["id"],
            name=warning["name"],
            found=warning["found"],
            required=_RECORDED.format(missing),
            holds=False,
            is_warning=True,
            remedy=warning["remedy"],
        )
        for warning in stored.get("warnings", [])
    ] or [
        Check(
            id="warnings",
            name="warnings",
            found="none",
            required=_RECORDED.format(missing),
            holds=None,
        )
    ]


def _placement(fractions: VolumeFractions) -> dict[str, Any] | None:
    return None if fractions.placement is None else fractions.placement.to_dict()


def _fractions(stored: VolumeFractions, sampled: VolumeFractions, tolerance: float) -> Check:
    """Return the check that fractions match the geometry within the sampling error."""
    found = f"another grid, {sampled.grid.label}"
    if stored.grid == sampled.grid:
        allowed = 2 * max(tolerance, RESOLUTION) / RESOLUTION
        n_other = int((np.abs(stored.multiples - sampled.multiples) > allowed).sum())
        found = f"{n_other:,} of {stored.multiples.size:,} differ"
    required = f"0 of {stored.multiples.size:,} differ"
    return Check(
        id="certificate_geometry",
        name="certificate: fractions from the geometry",
        found=found,
        required=required,
        holds=found == required,
    )


def _equal(key: str, name: str, found: Any, claimed: Any) -> Check:
    """Return the check that a recomputed value equals the value in the certificate."""
    is_same = found == claimed
    return Check(
        id=f"certificate_{key}",
        name=f"certificate: {name} from the geometry",
        found="as recorded" if is_same else f"not as recorded: {found}",
        required="as recorded",
        holds=is_same,
    )
