"""Volume fractions of several materials, stored sparsely for each place.

A place of the doubled grid keeps the materials whose fraction there is not 0, in ascending order,
so memory grows with the number of places, not of materials.  Places that decide nothing (faces in
3D, edges in 2D) stay empty.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.errors import SamplingError, TopologyError
from tusqh.grid import BackgroundGrid, FloatArray, IntArray, doubled
from tusqh.sampling.doubled_grid import RESOLUTION, Multiples, combine_half_blocks
from tusqh.sampling.fractions import VolumeFractions

#: Fraction of a full cell, in multiples of `RESOLUTION`.
FULL = round(1 / RESOLUTION)

#: Name of the region outside all materials.
VOID = "void"

#: Name of all materials together, without the void.
ALL = "all"


@dataclass(frozen=True)
class MaterialFractions:
    """The volume fractions of all materials at cells, edges and vertices of a background grid.

    Parameters
    ----------
    grid
        The background grid, of shape n.
    names
        The materials; if two have equal scores, the earlier one wins.  The last one is the void,
        which also fills everything outside the grid.
    start
        Place ``p`` of the doubled grid (flat) has the entries ``start[p] <= i < start[p + 1]``.
    material, multiple
        Material and fraction, in multiples of `RESOLUTION`, of every entry, shape (n_entries,).
    """

    grid: BackgroundGrid
    names: tuple[str, ...]
    start: IntArray
    material: NDArray[np.int32]
    multiple: NDArray[np.int32]

    @property
    def void(self) -> int:
        """Index of the void in `names`."""
        return len(self.names) - 1

    @classmethod
    def from_multiples(
        cls, grid: BackgroundGrid, names: Sequence[str], multiples: Iterable[Multiples]
    ) -> MaterialFractions:
        """Return the fractions of materials given one by one; the remainder is void.

        Parameters
        ----------
        grid
            The background grid, of shape n.
        names
            The materials without the void.
        multiples
            Fractions of each material on the doubled grid, shape ``2 n + 1``, in multiples of
            `RESOLUTION`; clipped to [0, 1].

        Raises
        ------
        TopologyError
            The fractions at a place add up to more than 1.
        """
        shape = tuple(2 * n + 1 for n in grid.shape)
        is_deciding = _is_deciding(shape)
        rest = np.full(shape, FULL, dtype=np.int64)
        places, materials, values = [], [], []
        fields: Iterable[NDArray[np.integer]] = chain(multiples, [rest])
        for k, field in enumerate(fields):
            if k == len(names):
                _require_at_most_one(rest[doubled.cells(grid.dim)])
            clipped = np.clip(field, 0, FULL).astype(np.int32)
            rest -= clipped
            place = np.flatnonzero((clipped.ravel() > 0) & is_deciding)
            places.append(place)
            materials.append(np.full(len(place), k, dtype=np.int32))
            values.append(clipped.ravel()[place])
        place = np.concatenate(places)
        order = np.argsort(place, kind="stable")
        start = np.searchsorted(place[order], np.arange(np.prod(shape) + 1))
        return cls(
            grid=grid,
            names=(*names, VOID),
            start=start.astype(np.int64),
            material=np.concatenate(materials)[order],
            multiple=np.concatenate(values)[order],
        )

    @classmethod
    def from_cells(
        cls,
        cells: Mapping[str, FloatArray],
        *,
        cell_size: float = 1.0,
        origin: tuple[float, ...] | None = None,
    ) -> MaterialFractions:
        """Return the fractions of materials that are known for cells only; the remainder is void.

        An edge or a vertex has the mean of the cells around it, so contacts are decided without
        knowledge of what lies in them.

        Parameters
        ----------
        cells
            Fractions of every material by name, shape (nx, ny) or (nx, ny, nz) each.
        cell_size
            Edge length of a cell, in model units.
        origin
            Lowest corner of the grid, in model units; 0 by default.

        Raises
        ------
        SamplingError
            The arrays are not of one shape of two or three axes.
        TopologyError
            The fractions of a cell add up to more than 1.

        Examples
        --------
        >>> halves = {"a": np.array([[0.5, 0.5]]), "b": np.array([[0.0, 0.5]])}
        >>> MaterialFractions.from_cells(halves).volumes()
        {'a': 1.0, 'b': 0.5, 'void': 0.5}
        """
        arrays = [np.asarray(array, dtype=np.float64) for array in cells.values()]
        shapes = {array.shape for array in arrays}
        if len(shapes) != 1 or arrays[0].ndim not in (2, 3) or not np.isfinite(arrays).all():
            raise SamplingError(
                f"volume fractions of the shapes {', '.join(map(str, sorted(shapes))) or 'none'}",
                where="volume fractions of several materials",
                expected="arrays of finite numbers and of one shape, with two or three axes",
                remedy="give one array for each material",
            )
        for name, array in zip(cells, arrays, strict=True):
            is_out = (array < 0) | (array > 1)
            if is_out.any() or name == VOID:
                worst = float(array[is_out].min()) if (array < 0).any() else float(array.max())
                place = tuple(int(k) for k in np.argwhere(array == worst)[0])
                raise SamplingError(
                    f"{int(is_out.sum())} cells with a fraction of {name!r} that is not between 0 "
                    f"and 1, for instance {worst:g} in cell {place}"
                    if is_out.any()
                    else f"a material called {VOID}",
                    where="volume fractions of several materials",
                    expected="fractions from 0 to 1, of materials with other names than void",
                    remedy="correct the fractions; void is what the materials leave",
                )
        dim = arrays[0].ndim
        grid = BackgroundGrid(arrays[0].shape, cell_size, origin or (0.0,) * dim)
        halves = [np.kron(array, np.ones((2,) * dim)).astype(np.float64) for array in arrays]
        return cls.from_multiples(grid, list(cells), [combine_half_blocks(h) for h in halves])

    @classmethod
    def from_fractions(
        cls, fractions: VolumeFractions, *, name: str = "material"
    ) -> MaterialFractions:
        """Return the fractions of one material and the void.

        Parameters
        ----------
        fractions
            Volume fractions of the material.
        name
            Name of the material.

        Examples
        --------
        >>> grid = BackgroundGrid(shape=(1, 1), cell_size=1.0, origin=(0.0, 0.0))
        >>> quarter = VolumeFractions.from_values(grid, 4, np.full((3, 3), 0.25))
        >>> found = MaterialFractions.from_fractions(quarter)
        >>> found.label_cells(np.array([FULL // 4, FULL - FULL // 4])).tolist()
        [[0]]
        """
        return cls.from_multiples(fractions.grid, [name], [fractions.multiples])

    def label_cells(self, thresholds: IntArray) -> NDArray[np.int32]:
        """Return the material of every cell: the one with the largest fraction over threshold.

        Parameters
        ----------
        thresholds
            Threshold of every material, in multiples of `RESOLUTION`, shape (m,).

        Returns
        -------
        labels
            Indices of materials, shape n; the void for a cell without materials.
        """
        shape = tuple(2 * n + 1 for n in self.grid.shape)
        places = np.arange(np.prod(shape), dtype=np.int64).reshape(shape)
        places = np.ascontiguousarray(places[doubled.cells(self.grid.dim)])
        return self.label_places(places.ravel(), thresholds).reshape(self.grid.shape)

    def label_places(self, places: IntArray, thresholds: IntArray) -> NDArray[np.int32]:
        """Return the material with the largest fraction over threshold at some places, shape (r,).

        Parameters
        ----------
        places
            Flat places of the doubled grid, shape (r,).
        thresholds
            Threshold of every material, in multiples of `RESOLUTION`, shape (m,).
        """
        entries = (self.start, self.material, self.multiple)
        return np.asarray(_best_of_places(places, entries, thresholds, self.void))

    def multiples_at(self, places: IntArray, labels: NDArray[np.int32]) -> IntArray:
        """Return the fractions of chosen materials at some places, in multiples of `RESOLUTION`.

        Parameters
        ----------
        places
            Flat places of the doubled grid, shape (r,).
        labels
            Materials to look up at each of them, shape (r, c).

        Returns
        -------
        multiples
            Shape (r, c), int64; 0 for materials that are absent.
        """
        entries = (self.start, self.material, self.multiple)
        return np.asarray(_look_up(places, labels, entries))

    def volumes(self) -> dict[str, float]:
        """Return the volume (2D: area) of every material in the cells, in model units."""
        shape = tuple(2 * n + 1 for n in self.grid.shape)
        is_cell = np.zeros(shape, dtype=bool)
        is_cell[doubled.cells(self.grid.dim)] = True
        counts = np.repeat(is_cell.ravel(), np.diff(self.start))
        sums = np.bincount(
            self.material[counts], weights=self.multiple[counts], minlength=len(self.names)
        )
        scale = RESOLUTION * self.grid.cell_size**self.grid.dim
        return dict(zip(self.names, (sums * scale).tolist(), strict=True))


def _require_at_most_one(rest: IntArray) -> None:
    """Raise an error if the fractions of a cell add up to more than 1, up to rounding."""
    n_over = int((rest < -64).sum())
    if n_over:
        worst = np.unravel_index(int(rest.argmin()), rest.shape)
        raise TopologyError(
            f"{n_over} cells in which the fractions of the materials add up to more than 1, the "
            f"worst to {1 - rest.min() * RESOLUTION:.4g}, in cell {tuple(map(int, worst))}",
            where="volume fractions of several materials",
            expected="at most 1 in every cell",
            remedy="let materials not overlap, or give the lens to one of them before",
        )


def _is_deciding(shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """Return which flat places are used in decisions: cells, vertices, and in 3D edges."""
    dimensions = doubled.place_dimensions(shape).ravel()
    return np.asarray(dimensions != len(shape) - 1)


@numba.njit(cache=True)
def _beats(f, k, g, j, thresholds):  # type: ignore[no-untyped-def]
    """Return whether material k with multiple f scores higher than j with multiple g."""
    left, right = f, g
    if f > 0 and g > 0:
        left, right = f * thresholds[j], g * thresholds[k]
    return left > right or (left == right and k < j)


@numba.njit(cache=True)
def _best_of_places(places, entries, thresholds, void):  # type: ignore[no-untyped-def]
    start, material, multiple = entries
    best = np.empty(len(places), dtype=np.int32)
    for i in range(len(places)):
        k, f = void, np.int64(0)
        for at in range(start[places[i]], start[places[i] + 1]):
            j, g = material[at], np.int64(multiple[at])
            if _beats(g, j, f, k, thresholds) and g > 0:
                k, f = j, g
        best[i] = k
    return best


@numba.njit(cache=True)
def _look_up(places, labels, entries):  # type: ignore[no-untyped-def]
    start, material, multiple = entries
    found = np.zeros(labels.shape, dtype=np.int64)
    for i in range(len(places)):
        for c in range(labels.shape[1]):
            for at in range(start[places[i]], start[places[i] + 1]):
                if material[at] == labels[i, c]:
                    found[i, c] = multiple[at]
    return found
