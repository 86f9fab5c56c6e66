"""Compute the fractions of several materials from their surfaces in space or outlines in the plane.

All materials are sampled on one lattice.  A sample belongs to the first material that contains it,
in the order given, so that two surfaces that overlap never share a place.  What the later one loses
there is the overlap of the two.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

import numba
import numpy as np

from tusqh.contacts.material_fractions import MaterialFractions
from tusqh.errors import SamplingError
from tusqh.geometry.kinds import Surface
from tusqh.grid import BackgroundGrid, FloatArray, IntArray
from tusqh.sampling.doubled_grid import Multiples, average_coverage, average_half_blocks
from tusqh.sampling.field import WindingField
from tusqh.sampling.half_blocks import SAMPLES_AT_A_TIME
from tusqh.sampling.inside import field_of, without_directions
from tusqh.sampling.lattice import Box, Lattice
from tusqh.sampling.orient import orient
from tusqh.settings.sampling import Sampling


@dataclass(frozen=True)
class SurfaceFractions:
    """The fractions of materials given by surfaces, and how far these overlap.

    Parameters
    ----------
    fractions
        Fractions of all materials.
    alone
        Volume (2D: area) of every surface alone in the grid, in model units, shape (m,).
    overlaps
        Entry (i, j) is the volume of surface j that the earlier surface i took, shape (m, m).
    """

    fractions: MaterialFractions
    alone: FloatArray
    overlaps: FloatArray


@dataclass(frozen=True)
class _Claims:
    """What every material takes: sums over half-blocks, stored sparsely by material.

    Parameters
    ----------
    blocks, sums
        For every material, flat half-blocks and the sums of the samples it takes there.
    alone, overlaps
        As for `SurfaceFractions`, in samples.
    """

    blocks: list[list[IntArray]]
    sums: list[list[FloatArray]]
    alone: FloatArray
    overlaps: FloatArray

    def take(self, kept: list[int]) -> _Claims:
        """Return the claims of some materials."""
        blocks, sums = [self.blocks[k] for k in kept], [self.sums[k] for k in kept]
        return _Claims(blocks, sums, self.alone[kept], self.overlaps[np.ix_(kept, kept)])


def fractions_of_surfaces(
    surfaces: Mapping[str, Surface],
    grid: BackgroundGrid,
    *,
    sampling: Sampling | None = None,
    window: Box | None = None,
    rest: str | None = None,
    optional: Collection[str] = (),
) -> SurfaceFractions:
    """Return the fractions of materials given by one surface or outline each.

    Samples are clipped to [0, 1], so a material may overlap itself.

    Parameters
    ----------
    surfaces
        Surface of every material, by name; where two overlap, the earlier one has priority.
    grid
        The background grid.
    sampling
        How the fractions are sampled; None: with the defaults.  `rule` and `domain` do not matter.
    window
        Box, in model units; everything outside it counts as void.
    rest
        Name of the material that fills what the surfaces leave of the grid or window; None: that is
        void.
    optional
        Surfaces that are left out if no sample lies inside.

    Raises
    ------
    SamplingError
        Another surface has no sample inside, or lies wholly inside earlier ones.

    Examples
    --------
    Of two squares that overlap in a quarter of their area, the first one has priority:

    >>> from tusqh.geometry.outline import Outline
    >>> square = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2], [0, 0]])
    >>> two = {"a": Outline.from_chains([square]), "b": Outline.from_chains([square + 1])}
    >>> found = fractions_of_surfaces(two, BackgroundGrid((3, 3), 1.0, (0.0, 0.0)))
    >>> found.fractions.volumes(), found.overlaps[0].tolist()
    ({'a': 4.0, 'b': 3.0, 'void': 2.0}, [0.0, 1.0])
    """
    sampling = sampling or Sampling()
    lattice = Lattice.over_grid(grid, sampling.samples, window)
    fields = [
        field_of(orient(s, sampling.orientation).geometry, sampling, grid.cell_size)
        for s in surfaces.values()
    ]
    claims = _claim_samples(fields, lattice, without_directions(sampling))
    names = list(surfaces)
    kept = [k for k, n in enumerate(names) if claims.alone[k] > 0 or n not in optional]
    if kept and len(kept) < len(names):
        names, claims = [names[k] for k in kept], claims.take(kept)
    _require_material(names, claims, grid)
    multiples = _multiples(claims, lattice)
    if rest is not None:
        names.append(rest)
        multiples = _with_rest(multiples, lattice)
    volume = (grid.cell_size / sampling.samples) ** grid.dim
    return SurfaceFractions(
        MaterialFractions.from_multiples(grid, names, multiples),
        claims.alone * volume,
        claims.overlaps * volume,
    )


def _claim_samples(fields: list[WindingField], lattice: Lattice, sampling: Sampling) -> _Claims:
    """Return what every material takes of the samples, slab by slab along x."""
    m = len(fields)
    signs = [_sign(field, lattice, sampling) for field in fields]
    claims = _Claims([[] for _ in fields], [[] for _ in fields], np.zeros(m), np.zeros((m, m)))
    single, half = lattice.of_samples(), lattice.half
    n_x, n_y, n_z = (int(n) for n in lattice.n_blocks)
    columns = max(1, SAMPLES_AT_A_TIME // int(half.prod() * n_y * n_z))
    for begin in range(0, n_x, columns):
        end = min(begin + columns, n_x)
        shape = ((end - begin) * int(half[0]), *(int(n) for n in single.n_blocks[1:]))
        free, owner = np.ones(shape), np.full(shape, -1, dtype=np.int32)
        for k, field in enumerate(fields):
            values = field.sums(single, begin * int(half[0]), end * int(half[0]))
            sums = np.zeros((end - begin, n_y, n_z))
            claims.alone[k] += _claim(
                signs[k] * values, half, k, free, owner, claims.overlaps[:, k], sums
            )
            taken = np.flatnonzero(sums)
            claims.blocks[k].append(begin * n_y * n_z + taken)
            claims.sums[k].append(sums.ravel()[taken])
    return claims


def _sign(field: WindingField, lattice: Lattice, sampling: Sampling) -> int:
    """Return -1 if the winding number must be negated, otherwise 1."""
    if sampling.orientation != "auto":
        return -1 if sampling.orientation == "flip" else 1
    return -1 if field.sums(lattice, 0, int(lattice.n_blocks[0])).sum() < 0 else 1


def _multiples(claims: _Claims, lattice: Lattice) -> Iterator[Multiples]:
    """Yield the fractions of every material on the doubled grid."""
    shape = tuple(int(n) for n in lattice.n_blocks)
    for blocks, sums in zip(claims.blocks, claims.sums, strict=True):
        dense = np.zeros(shape)
        dense.ravel()[np.concatenate(blocks)] = np.concatenate(sums)
        yield average_half_blocks([dense], lattice)


def _with_rest(multiples: Iterator[Multiples], lattice: Lattice) -> Iterator[Multiples]:
    """Yield fractions, and at the end those of the rest of the grid or window."""
    rest = average_coverage(lattice)
    for found in multiples:
        rest = rest - found
        yield found
    yield np.maximum(rest, 0)


def _require_material(names: list[str], claims: _Claims, grid: BackgroundGrid) -> None:
    """Raise a `SamplingError` for a material that has no sample, or none of its own."""
    for k, name in enumerate(names):
        own = sum(float(sums.sum()) for sums in claims.sums[k])
        if own > 1e-6 * claims.alone[k]:
            continue
        earlier = [names[i] for i in np.flatnonzero(claims.overlaps[:, k])]
        if earlier:
            raise SamplingError(
                f"the material {name!r} lies wholly inside {', '.join(map(repr, earlier))}, which "
                "come first and take all of it",
                where="materials",
                expected="a place that only this material fills, or that it fills first",
                remedy=f"list {name!r} before {', '.join(map(repr, earlier))}",
            )
        raise SamplingError(
            f"no sample lies in the material {name!r} on the {grid.label} grid",
            where="materials",
            expected="a closed surface that is larger than the distance of samples",
            remedy=f"use cells smaller than {grid.cell_size:.4g}, or correct the window",
        )


@numba.njit(cache=True)
def _claim(values, half, k, free, owner, overlap, sums):  # type: ignore[no-untyped-def]
    """Give the free part of every sample to material k, and return the sum of its samples."""
    total = 0.0
    n_x, n_y, n_z = values.shape
    for i in range(n_x):
        for j in range(n_y):
            for n in range(n_z):
                value = min(max(values[i, j, n], 0.0), 1.0)
                if value == 0.0:
                    continue
                total += value
                taken = min(value, free[i, j, n])
                if taken < value:
                    overlap[owner[i, j, n]] += value - taken
                if taken > 0.0:
                    if owner[i, j, n] < 0:
                        owner[i, j, n] = k
                    free[i, j, n] -= taken
                    sums[i // half[0], j // half[1], n // half[2]] += taken
    return total
