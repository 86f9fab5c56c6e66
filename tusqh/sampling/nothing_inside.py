"""The error for a geometry in which no sample has a winding number."""

from __future__ import annotations

import numpy as np

from tusqh.errors import SamplingError
from tusqh.geometry.kinds import Surface
from tusqh.geometry.outline import Outline
from tusqh.grid import FloatArray


def nothing_inside(geometry: Surface, spacing: float) -> SamplingError:
    """Return the error that says why the winding number is zero at every sample.

    Parameters
    ----------
    geometry
        The geometry.
    spacing
        Distance of the samples, in model units.
    """
    sides = _least_sides(geometry)
    if len(sides) and sides.max() < spacing:
        parts = "ring" if isinstance(geometry, Outline) else "part"
        largest = f"{len(sides):,} {parts}s, the largest {sides.max():.3g} across"
        one = f"one {parts}, {sides.max():.3g} across"
        return SamplingError(
            f"no sample lies inside: the geometry has {largest if len(sides) > 1 else one}, and "
            f"the samples are {spacing:.3g} apart",
            where=geometry.name,
            expected="parts larger than the spacing of the samples",
            remedy=f"use `--cell-size {sides.max() / 2:.3g}`, which puts two cells across, a "
            "`--window` around the parts, or more `--samples`",
        )
    return SamplingError(
        "the winding number is zero everywhere, so the geometry has no inside",
        where=geometry.name,
        expected="a geometry that encloses something, with each boundary traversed once",
        remedy="remove one of the two copies if every boundary is traversed twice in opposite "
        "directions (double-sided sheets)",
    )


def _least_sides(geometry: Surface) -> FloatArray:
    """Return the smallest nonzero side of the bounding box of every chain or part."""
    if isinstance(geometry, Outline):
        corners, owners = geometry.segments, geometry.chains
    else:
        corners, owners = geometry.triangles, geometry.parts
    _, owner = np.unique(owners, return_inverse=True)
    n, dim = int(owner.max()) + 1, geometry.points.shape[1]
    low, high = np.full((n, dim), np.inf), np.full((n, dim), -np.inf)
    for corner in corners.T:
        np.minimum.at(low, owner, geometry.points[corner])
        np.maximum.at(high, owner, geometry.points[corner])
    sides = (high - low).min(axis=1)
    return np.asarray(sides[sides > 0])
