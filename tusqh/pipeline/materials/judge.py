"""Judge a mesh of several materials: every material, and all together without the void."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
import pandas as pd

from tusqh.antialias.scheme import PINCH_TEMPLATES
from tusqh.contacts import MaterialFractions
from tusqh.contacts.material_fractions import ALL
from tusqh.extras import MissingExtraError
from tusqh.grid import IntArray
from tusqh.meshes.checks import Check
from tusqh.meshes.measure_regions import RegionMeasurement, measure_regions
from tusqh.meshes.regions import Regions
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.pipeline.judge import Judgement
from tusqh.quality.elements import element_metrics, summarise_metrics
from tusqh.quality.verdict import check_overlap, judge_by_others, skip_others, to_table
from tusqh.settings.quality import MOST_ELEMENTS
from tusqh.topology.betti_numbers import BettiNumbers


def measure_materials(mesh: VolumeMesh, regions: Regions) -> dict[str, RegionMeasurement]:
    """Return the measurement of every material that has elements, and of all without the void.

    Parameters
    ----------
    mesh
        The mesh.
    regions
        The material of every element; the last name is the void.
    """
    found = measure_regions(mesh, regions.material, len(regions.names))
    measured = {name: m for name, m in zip(regions.names, found, strict=True) if m.n_cells}
    is_void = (regions.material == len(regions.names) - 1).astype(np.int64)
    if is_void.any():
        return {**measured, ALL: measure_regions(mesh, is_void, 2)[0]}
    return {**measured, ALL: RegionMeasurement.of(mesh.measurement)}


def judge_all(
    mesh: VolumeMesh,
    regions: Regions,
    measured: Mapping[str, RegionMeasurement],
    predicted: Mapping[str, BettiNumbers] | None = None,
    *,
    comparison: Sequence[Check] = (),
    checks: Literal["all"] | None = None,
) -> Judgement:
    """Return all checks of a mesh and its materials, by our own counts, VTK, MFEM and pymeshlab.

    Parameters
    ----------
    mesh, regions
        The mesh and the material of every element; the last name is the void.
    measured, predicted
        See `judge_materials`.
    comparison
        Further checks, such as those of `compare_volumes`.
    checks
        Whether other programs check large meshes too, see `tusqh.settings.quality.Quality`.
    """
    own, others, metrics = judge_materials(mesh, measured, predicted), list[Check](), None
    is_sound = mesh.measurement.is_sound
    if is_sound and all(found.n_non_manifold == 0 for found in measured.values()):
        expected = predicted or {name: found.by_euler for name, found in measured.items()}
        others, metrics = judge_parts_by_others(mesh, regions, expected, checks=checks)
    elements = summarise_metrics(pd.DataFrame() if metrics is None else metrics, unit=mesh.unit)
    return Judgement(elements, to_table([*own, *others, *comparison]))


def judge_materials(
    mesh: VolumeMesh,
    measured: Mapping[str, RegionMeasurement],
    predicted: Mapping[str, BettiNumbers] | None = None,
) -> list[Check]:
    """Return our own checks of a mesh, of each of its materials, and of all together.

    Parameters
    ----------
    mesh
        The mesh.
    measured
        See `measure_materials`.
    predicted
        Betti numbers that every material and all together must have; None: those by the Euler
        characteristic, with which the other method must agree.
    """
    smallest, bound = mesh.measurement.smallest_scaled_jacobian, PINCH_TEMPLATES.bound_of(mesh)
    checks = [
        *mesh.measurement.checks,
        Check(
            id="scaled_jacobian",
            name="smallest scaled Jacobian",
            found=f"{smallest:.6f}",
            required=f">= {bound:.6f}",
            holds=PINCH_TEMPLATES.allows(smallest, mesh),
        ),
    ]
    if mesh.measurement.is_sound:
        checks.append(check_overlap(mesh))
    for name, found in measured.items():
        expected = found.by_euler if predicted is None else predicted[name]
        checks.append(
            Check(
                id=f"manifold_{name}",
                name=f"{name}: non-manifold boundary points",
                found=found.n_non_manifold,
                required="0",
                holds=found.n_non_manifold == 0,
                material=name,
            )
        )
        for how, betti in (
            ("Euler characteristic", found.by_euler),
            ("boundary", found.by_boundary),
        ):
            checks.append(
                Check(
                    id=f"betti_by_{how.split()[0].lower()}_{name}",
                    name=f"{name}: Betti numbers by {how}",
                    found=betti,
                    required=str(expected),
                    holds=betti == expected,
                    material=name,
                )
            )
    return checks


def judge_parts_by_others(
    mesh: VolumeMesh,
    regions: Regions,
    predicted: Mapping[str, BettiNumbers],
    *,
    checks: Literal["all"] | None = None,
) -> tuple[list[Check], pd.DataFrame | None]:
    """Return the checks by VTK, MFEM and pymeshlab of each material and of all together.

    Every material is judged as a mesh of its own, with its own points.

    Parameters
    ----------
    mesh, regions
        The mesh and the material of every element; our own checks of them hold.
    predicted
        Betti numbers that every material and all together must have.
    checks
        Whether large meshes are checked too, see `tusqh.settings.quality.Quality`.

    Returns
    -------
    checks
        The checks.
    metrics
        VTK's metrics of every element; None if VTK did not run.
    """
    if checks != "all" and mesh.n_cells > MOST_ELEMENTS:
        return skip_others(f"{mesh.n_cells:,} elements; `--all-checks` runs them"), None
    try:
        metrics = element_metrics(mesh)
    except MissingExtraError:
        metrics = None
    found = []
    for name, chosen in _list_parts(regions).items():
        of_part = None if metrics is None else metrics.iloc[chosen]
        part = mesh.take(chosen, name=name)
        overlap = [] if name == ALL else [check_overlap(part)]
        found += [
            replace(check, id=f"{check.id}_{name}", name=f"{name}: {check.name}", material=name)
            for check in [*overlap, *judge_by_others(part, predicted[name], of_part)]
        ]
    return found, metrics


def _list_parts(regions: Regions) -> dict[str, IntArray]:
    """Return the elements of every material that has any, and of all without the void."""
    material, names = regions.material, regions.names
    parts = {names[k]: np.flatnonzero(material == k) for k in np.unique(material).tolist()}
    return {**parts, ALL: np.flatnonzero(material != len(names) - 1)}


def volumes_of_geometry(fractions: MaterialFractions) -> dict[str, float]:
    """Return the volume of every material in its fractions, and of all without the void.

    Parameters
    ----------
    fractions
        Fractions of all materials.
    """
    volumes = fractions.volumes()
    return {**volumes, ALL: sum(volumes[name] for name in fractions.names[:-1])}


def compare_volumes(
    measured: Mapping[str, RegionMeasurement], volumes: Mapping[str, float], tolerance: float
) -> list[Check]:
    """Return a warning for every material whose volume differs from that of its geometry.

    Parameters
    ----------
    measured
        See `measure_materials`.
    volumes
        See `volumes_of_geometry`.
    tolerance
        Largest relative difference.
    """
    ratios = {name: found.volume / volumes[name] for name, found in measured.items()}
    return [
        Check(
            id=f"volume_{name}",
            name=f"{name}: volume",
            found=f"{ratio:.4f} of the volume of its geometry",
            required=f"within {tolerance:.0%}",
            holds=abs(ratio - 1) <= tolerance,
            is_warning=True,
            remedy="use smaller cells, or another threshold for this material",
            material=name,
        )
        for name, ratio in ratios.items()
    ]
