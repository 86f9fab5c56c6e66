"""Check a mesh of several materials, and recompute the certificate beside it from its files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pandas as pd

from tusqh.certificate import FILE_NAME
from tusqh.contacts import MaterialFractions, MaterialMesh, mesh_materials
from tusqh.contacts.fractions_file import load_materials
from tusqh.errors import TusqhError
from tusqh.hashing import hash_file
from tusqh.local_topology.local_labels import MaterialWish, label_locally
from tusqh.local_topology.relabel import Labels
from tusqh.meshes.checks import Check
from tusqh.meshes.regions import Regions
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.pipeline.materials.certificate import (
    claims_of_fractions,
    claims_of_mesh,
    read_certificate,
    read_materials,
)
from tusqh.pipeline.materials.judge import (
    compare_volumes,
    judge_all,
    measure_materials,
    volumes_of_geometry,
)
from tusqh.pipeline.materials.original import MaterialsOriginal
from tusqh.pipeline.original import to_warnings
from tusqh.sampling.doubled_grid import RESOLUTION
from tusqh.topology.betti_numbers import BettiNumbers

#: Largest distance of a point from that of the mesh made again, in cells.
_ROUNDING = 1e-9


def check_materials(mesh_file: Path, *, checks: Literal["all"] | None = None) -> pd.DataFrame:
    """Return the checks of a mesh file of several materials, and of the certificate beside it.

    With the fractions, the mesh is made again and compared with the file; with the geometry, the
    fractions are sampled again and compared with theirs.

    Parameters
    ----------
    mesh_file
        A VTU file with materials.
    checks
        Whether other programs check large meshes too, see `tusqh.settings.quality.Quality`.

    Returns
    -------
    verdict
        One row per check, see `tusqh.quality.verdict.to_table`.

    Raises
    ------
    MeshError
        The mesh or its certificate cannot be read.
    """
    mesh, regions = read_materials(mesh_file)
    measured = measure_materials(mesh, regions)
    path = mesh_file.parent / FILE_NAME
    if not path.is_file():
        return judge_all(mesh, regions, measured, checks=checks).verdict
    stored = read_certificate(path)
    predicted = {name: BettiNumbers(*betti) for name, betti in stored["predicted"].items()}
    predicted |= {n: m.by_euler for n, m in measured.items() if n not in predicted}
    claims = [_same_file("mesh", mesh_file, stored)]
    claims += _compare(claims_of_mesh(mesh, measured, predicted), stored)
    fractions_file = path.parent / stored["fractions"]["file"]
    if fractions_file.is_file():
        fractions = load_materials(fractions_file)
        labels, differing = _label_again(fractions, stored)
        again = mesh_materials(fractions, thresholds=stored["thresholds"], labels=labels)
        volumes = compare_volumes(
            measured, _known(volumes_of_geometry(fractions), measured), stored["volume_tolerance"]
        )
        claims += [
            _same_file("fractions", fractions_file, stored),
            *_compare({**claims_of_fractions(again), "warnings": to_warnings(volumes)}, stored),
            _count_other_elements(mesh, regions, again, fractions.grid.cell_size),
            *differing,
            *_check_geometry(path.parent, stored, fractions),
            *volumes,
        ]
    else:
        claims += _recorded(stored["warnings"], fractions_file.name)
    return judge_all(mesh, regions, measured, predicted, comparison=claims, checks=checks).verdict


def _label_again(
    fractions: MaterialFractions, stored: Mapping[str, Any]
) -> tuple[Labels | None, list[Check]]:
    """Return the materials of cells that differ from the base, and the check of their number."""
    if "base" not in stored:
        return None, []
    wishes = [MaterialWish(**wish) for wish in stored["features"]]
    try:
        local = label_locally(fractions, stored["thresholds"], stored["base"], wishes)
    except (TusqhError, IndexError) as reason:
        found = f"cannot be repeated: {getattr(reason, 'found', 'a class does not exist')}"
        labels = None
    else:
        found, labels = f"{local.n_changes:,}", local.labels
    required = f"{stored['changed_cells']:,}"
    return labels, [
        Check(
            id="certificate_changes",
            name="certificate: cells that differ from the base",
            found=found,
            required=required,
            holds=found == required,
        )
    ]


def _known(volumes: dict[str, float], measured: Mapping[str, Any]) -> dict[str, float]:
    """Return volumes of all measured materials; of those without any in the fractions, NaN."""
    return {name: volumes.get(name) or float("nan") for name in measured}


def _check_geometry(
    folder: Path, stored: Mapping[str, Any], fractions: MaterialFractions
) -> list[Check]:
    """Return the check that fractions, sampled again from the geometry, are those of the file."""
    name = "certificate: fractions from the geometry"
    if "geometry" not in stored:
        return []
    path = folder / stored["geometry"]["file"]
    if not path.is_file():
        return [
            Check(
                id="certificate_resampled",
                name=name,
                found=f"not run: {path.name} is missing from the folder",
                required="the same",
                holds=None,
            )
        ]
    original = MaterialsOriginal.load(path, stored["settings"])
    try:
        found = _count_differences(fractions, original)
    except TusqhError as reason:
        found = f"cannot be sampled: {reason.found}"
    required = "0 of all values differ"
    return [
        _same_file("geometry", path, stored),
        Check(
            id="certificate_resampled",
            name=name,
            found=found,
            required=required,
            holds=found == required,
        ),
    ]


def _count_differences(fractions: MaterialFractions, original: MaterialsOriginal) -> str:
    """Return how many fractions are not those of the geometry, in words."""
    again = original.sample().fractions
    if again.grid != fractions.grid:
        return f"another grid, {again.grid.label}"
    if again.names != fractions.names:
        return f"other materials: {', '.join(again.names)}"
    allowed = 2 * max(original.sampling.tolerance, RESOLUTION) / RESOLUTION
    (places, values), (others, other_values) = map(_list_values, (fractions, again))
    every = np.union1d(places, others)
    difference = np.zeros(len(every), dtype=np.int64)
    difference[np.searchsorted(every, places)] += values
    difference[np.searchsorted(every, others)] -= other_values
    n_other = int((np.abs(difference) > allowed).sum())
    return f"{n_other:,} of {len(every):,} values differ" if n_other else "0 of all values differ"


def _list_values(fractions: MaterialFractions) -> tuple[Any, Any]:
    """Return the place and material of every stored fraction as one number, and the fraction."""
    at = np.repeat(np.arange(len(fractions.start) - 1), np.diff(fractions.start))
    return at * len(fractions.names) + fractions.material, fractions.multiple.astype(np.int64)


def _count_other_elements(
    mesh: VolumeMesh, regions: Regions, again: MaterialMesh, cell_size: float
) -> Check:
    """Return the check that every element and its material is that of the fractions."""
    made, found = again.mesh, "0 elements differ"
    is_same_size = made.cells.shape == mesh.cells.shape and made.points.shape == mesh.points.shape
    if regions.names != again.names:
        found = f"other materials: {', '.join(regions.names)}"
    elif not is_same_size:
        found = f"{mesh.n_cells:,} elements instead of {made.n_cells:,}"
    else:
        has_moved = np.abs(mesh.points - made.points).max(axis=1) > _ROUNDING * cell_size
        is_other = (mesh.cells != made.cells).any(axis=1) | has_moved[mesh.cells].any(axis=1)
        is_other |= regions.material != again.material
        found = f"{int(is_other.sum()):,} elements differ" if is_other.any() else found
    return Check(
        id="certificate_elements",
        name="certificate: elements and materials from the fractions",
        found=found,
        required="0 elements differ",
        holds=found == "0 elements differ",
    )


def _recorded(warnings: list[dict[str, str]], missing: str) -> list[Check]:
    """Return the recorded warnings of a certificate, which cannot be recomputed."""
    return [
        Check(
            id=row["id"],
            name=row["name"],
            found=row["found"],
            required=f"as recorded by the certificate: {missing} is missing from its folder",
            holds=False,
            is_warning=True,
            remedy=row["remedy"],
        )
        for row in warnings
    ]


def _same_file(key: str, path: Path, stored: Mapping[str, Any]) -> Check:
    """Return the check that a file has the digest that the certificate states."""
    found, claimed = hash_file(path), stored[key]["sha256"]
    return Check(
        id=f"certificate_{key}",
        name=f"certificate: SHA-256 of {path.name}",
        found=found[:12],
        required=claimed[:12],
        holds=found == claimed,
    )


def _compare(found: Mapping[str, Any], claimed: Mapping[str, Any]) -> list[Check]:
    """Return the checks of claims that were recomputed."""
    return [
        Check(
            id=f"certificate_{key}",
            name=f"certificate: {key}",
            found="as recorded" if value == claimed[key] else f"not as recorded: {str(value)[:60]}",
            required="as recorded",
            holds=value == claimed[key],
        )
        for key, value in found.items()
    ]
