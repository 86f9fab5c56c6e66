"""The error for a geometry in which no sample lies inside."""

from __future__ import annotations

import numpy as np

from tusqh.errors import SamplingError
from tusqh.geometry.kinds import Surface
from tusqh.geometry.outline import Outline
from tusqh.grid import FloatArray
from tusqh.sampling.doubled_grid import RESOLUTION
from tusqh.sampling.inside_lengths import seal_of
from tusqh.settings.sampling import Sampling

#: If no fraction of an envelope is as large, only the roundings of its edges are left.
LEAST_MADE = round(1 / 8 / RESOLUTION)


def nothing_inside(geometry: Surface, sampling: Sampling, cell_size: float) -> SamplingError:
    """Return the error that says why no sample lies inside.

    Parameters
    ----------
    geometry
        The geometry.
    sampling
        How it was sampled.
    cell_size
        Edge length of a cell, in model units.
    """
    if sampling.inside != "winding":
        return _nothing_made(geometry, sampling, cell_size)
    sides, spacing = _least_sides(geometry), cell_size / sampling.samples
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
        remedy="use `--inside envelope` if sheets close a space, double-sided or with gaps "
        f"narrower than half a cell ({cell_size / 2:.3g}); or `--inside shell --thickness "
        f"{cell_size:.3g}`, which makes the sheets one cell thick",
    )


def _nothing_made(geometry: Surface, sampling: Sampling, cell_size: float) -> SamplingError:
    """Return the error for an envelope or a shell that holds nearly nothing."""
    if sampling.inside != "envelope":
        return SamplingError(
            f"nearly no sample lies in the {sampling.inside}",
            where=geometry.name,
            expected="a grid or window that holds a part of the surface",
            remedy="correct `window`, or use more `--samples`",
        )
    seal = seal_of(geometry, sampling, cell_size)
    return SamplingError(
        f"a ball {seal:.3g} across reaches all places, so the envelope is empty",
        where=geometry.name,
        expected="a surface with openings narrower than the ball (`seal`)",
        remedy=f"use a larger ball, such as `--seal {2 * seal:.3g}`, or make solids of sheets with "
        f"`--inside shell --thickness {cell_size:.3g}`",
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
