"""Judge a mesh of several materials: every material, and all together without the void."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from tusqh.antialias.scheme import PINCH_TEMPLATES
from tusqh.meshes.checks import Check
from tusqh.meshes.measure_regions import RegionMeasurement, measure_regions
from tusqh.meshes.regions import Regions
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.topology.betti_numbers import BettiNumbers

#: Name of all materials together, without the void.
ALL = "all"


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


def judge_materials(
    mesh: VolumeMesh,
    measured: Mapping[str, RegionMeasurement],
    predicted: Mapping[str, BettiNumbers] | None = None,
) -> list[Check]:
    """Return the checks of a mesh and of its materials.

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
    for name, found in measured.items():
        expected = found.by_euler if predicted is None else predicted[name]
        checks.append(
            Check(
                id=f"manifold_{name}",
                name=f"{name}: non-manifold boundary points",
                found=found.n_non_manifold,
                required="0",
                holds=found.n_non_manifold == 0,
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
                )
            )
    return checks


def compare_volumes(materials: pd.DataFrame, tolerance: float) -> list[Check]:
    """Return a warning for every material whose volume differs from that of its geometry.

    Parameters
    ----------
    materials
        See `tusqh.pipeline.materials.result.MaterialsResult.materials`.
    tolerance
        Largest relative difference.
    """
    ratios = (materials["volume"] / materials["volume_of_geometry"]).tolist()
    return [
        Check(
            id=f"volume_{name}",
            name=f"{name}: volume",
            found=f"{ratio:.4f} of the volume of its geometry",
            required=f"within {tolerance:.0%}",
            holds=abs(ratio - 1) <= tolerance,
            is_warning=True,
            remedy="use smaller cells, or another threshold for this material",
        )
        for name, ratio in zip(materials["material"], ratios, strict=True)
    ]
