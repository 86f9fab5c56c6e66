"""Find the contacts between kept and empty cells, and their votes, at one threshold or at many.

The eight cells around a vertex are a mask of kept octants; tables state which masks are pinched, at
the vertex and along its three upper edges.  Every contact follows its vote (`tusqh.contacts`), so
these are the decisions, without the templates that realise them.
"""

from __future__ import annotations

from functools import cache

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.contacts.decided import Contacts, Labels
from tusqh.contacts.octants import BITS, octants
from tusqh.contacts.one_material import MATERIAL, VOID
from tusqh.contacts.planar import find_pinched
from tusqh.contacts.surround import LAYERS_OF, inner_cells
from tusqh.grid import BoolArray, IntArray, doubled
from tusqh.grid.slabs import PackedBits
from tusqh.sampling.doubled_grid import Multiples

#: The four cells around a vertex of the plane in cyclic order, by offset.
_CYCLIC: IntArray = np.array([[-1, -1], [0, -1], [0, 0], [-1, 0]], dtype=np.int64)


def label_cells(kept: BoolArray) -> Labels:
    """Return the labels of kept and empty cells with the layers of void that decisions need.

    Parameters
    ----------
    kept
        Kept cells, shape n.
    """
    labels = np.full([n + 2 * LAYERS_OF[kept.ndim] for n in kept.shape], VOID, dtype=np.int32)
    labels[inner_cells(kept.ndim)][kept] = MATERIAL
    return labels


def find_contacts(kept: BoolArray, is_interior: BoolArray | PackedBits) -> Contacts:
    """Return the contacts of kept cells with the votes of their sub-cells.

    Parameters
    ----------
    kept
        Kept cells, shape n.
    is_interior
        Whether the fraction is at least the threshold, on the doubled grid, shape ``2 n + 1``.

    Examples
    --------
    >>> interior = np.ones((5, 5), dtype=bool)
    >>> find_contacts(np.eye(2, dtype=bool), interior).ball.tolist() == [MATERIAL]
    True
    """
    dim = kept.ndim
    if dim == 2:
        places = np.argwhere(find_pinched(label_cells(kept))[1:-1, 1:-1])
        edges: list[IntArray] = []
        offsets = _CYCLIC
    else:
        found = _scan(np.pad(kept, 1), octants().is_pinched, _edge_table())
        vertex_shape = tuple(n + 1 for n in kept.shape)
        places, *edges = (np.stack(np.unravel_index(v, vertex_shape), axis=1) for v in found)
        offsets = BITS - 1
    shape = tuple(n + 2 * LAYERS_OF[dim] for n in kept.shape)
    ball = np.where(_at(is_interior, 2 * places), MATERIAL, VOID)
    edge_cells, edge_material = [np.empty((0, 4), dtype=np.int64)], [np.empty(0, dtype=np.int32)]
    for axis, starts in enumerate(edges):
        around = offsets[octants().around[2 * axis + 1]]
        edge_cells.append(_cells_around(starts, around, shape))
        middle = 2 * starts + (np.arange(3) == axis)
        edge_material.append(np.where(_at(is_interior, middle), MATERIAL, VOID))
    cells = _cells_around(places, offsets, shape)
    return Contacts(
        vertex_cells=cells,
        ball=ball.astype(np.int32),
        sticks=_sticks_at(cells, edge_cells[1:], edge_material[1:]),
        edge_cells=np.concatenate(edge_cells),
        edge_material=np.concatenate(edge_material).astype(np.int32),
    )


def count_contacts(multiples: Multiples, thresholds: IntArray) -> IntArray:
    """Return the number of contacts at many thresholds, from one pass over the grid.

    Parameters
    ----------
    multiples
        Fractions on the doubled grid, shape ``2 n + 1``, in multiples of 2**-20.
    thresholds
        Thresholds above 0 in multiples of 2**-20, ascending, shape (r,).

    Returns
    -------
    n_contacts
        Shape (r,).

    Examples
    --------
    >>> multiples = np.zeros((5, 5), dtype=np.int32)
    >>> multiples[1, 1], multiples[3, 3], multiples[1, 3] = 3, 2, 1
    >>> count_contacts(multiples, np.array([1, 2, 3])).tolist()
    [0, 1, 0]
    """
    cells = np.pad(multiples[doubled.cells(multiples.ndim)], 1)
    per_mask = np.zeros(2**8, dtype=np.int64)
    if multiples.ndim == 2:
        # A mask of the plane is one of space without upper cells; the diagonals are pinched.
        cells = cells[..., None]
        per_mask[[0b0110, 0b1001]] = 1
    else:
        per_mask += octants().is_pinched
        per_mask += sum(_edge_table() >> axis & 1 for axis in range(3))
    steps = np.zeros(len(thresholds) + 1, dtype=np.int64)
    _count(np.ascontiguousarray(cells), thresholds, per_mask, steps)
    return np.cumsum(steps)[:-1]


def _at(is_interior: BoolArray | PackedBits, places: IntArray) -> BoolArray:
    """Return the values at some places, shape (r,)."""
    return np.asarray(is_interior[tuple(places.T)])


@cache
def _edge_table() -> NDArray[np.uint8]:
    """Return, for every mask of octants, which upper edges are pinched, as bits of their axes."""
    table = np.zeros(256, dtype=np.uint8)
    masks = np.arange(256)
    for axis in range(3):
        a, b, c, d = ((masks >> octant) & 1 for octant in octants().around[2 * axis + 1])
        table |= (((a == c) & (b == d) & (a != b)) << axis).astype(np.uint8)
    return table


def _cells_around(places: IntArray, offsets: IntArray, shape: tuple[int, ...]) -> IntArray:
    """Return the flat cells of a padded grid around vertices, shape (r, number of offsets)."""
    cells = places[:, None] + offsets + LAYERS_OF[len(shape)]
    flat = np.ravel_multi_index(tuple(np.moveaxis(cells, -1, 0)), shape)
    return np.asarray(flat, dtype=np.int64)


def _sticks_at(
    cells: IntArray, edge_cells: list[IntArray], edge_material: list[NDArray[np.int32]]
) -> Labels:
    """Return the materials of pinched edges at the six half-edges of vertices, -1 for others."""
    sticks = np.full((len(cells), 2 * len(edge_cells)), -1, dtype=np.int32)
    for axis, (around, material) in enumerate(zip(edge_cells, edge_material, strict=True)):
        if len(around) == 0:
            continue
        for side in (0, 1):
            # The cells around an edge start with the lowest one, and ascend with the edges.
            own = cells[:, octants().around[2 * axis + side][0]]
            at = np.minimum(np.searchsorted(around[:, 0], own), len(around) - 1)
            is_edge = around[at, 0] == own
            sticks[is_edge, 2 * axis + side] = material[at[is_edge]]
    return sticks


@numba.njit(cache=True)
def _scan(kept, is_pinched, edge_bits):  # type: ignore[no-untyped-def]
    """Return the flat numbers of pinched vertices, and of the starts of pinched edges by axis."""
    n_x, n_y, n_z = kept.shape[0] - 1, kept.shape[1] - 1, kept.shape[2] - 1
    found = np.empty((4, 1024), dtype=np.int64)
    counts = np.zeros(4, dtype=np.int64)
    for i in range(n_x):
        for j in range(n_y):
            low = np.int64(0)
            for k in range(n_z + 1):
                high = np.int64(kept[i, j, k]) + 2 * np.int64(kept[i + 1, j, k])
                high += 4 * np.int64(kept[i, j + 1, k]) + 8 * np.int64(kept[i + 1, j + 1, k])
                mask = low + 16 * high
                low = high
                if k == 0 or not is_pinched[mask]:
                    continue
                if counts.max() == found.shape[1]:
                    found = np.concatenate((found, np.empty_like(found)), axis=1)
                v = (i * n_y + j) * n_z + k - 1
                found[0, counts[0]] = v
                counts[0] += 1
                for axis in range(3):
                    if edge_bits[mask] >> axis & 1:
                        found[1 + axis, counts[1 + axis]] = v
                        counts[1 + axis] += 1
    return (
        found[0, : counts[0]].copy(),
        found[1, : counts[1]].copy(),
        found[2, : counts[2]].copy(),
        found[3, : counts[3]].copy(),
    )


@numba.njit(cache=True)
def _count(cells, thresholds, per_mask, steps):  # type: ignore[no-untyped-def]
    """Add, at every threshold, the change of the number of contacts to `steps`."""
    n_x, n_y = cells.shape[0] - 1, cells.shape[1] - 1
    in_plane = cells.shape[2] == 1
    n_z = 1 if in_plane else cells.shape[2] - 1
    n = 4 if in_plane else 8
    value = np.empty(8, dtype=np.int64)
    octant = np.empty(8, dtype=np.int64)
    for i in range(n_x):
        for j in range(n_y):
            for k in range(n_z):
                lowest = highest = cells[i, j, k]
                for a in range(n):
                    f = cells[i + (a & 1), j + (a >> 1 & 1), k + (a >> 2)]
                    lowest, highest = min(lowest, f), max(highest, f)
                    at = a
                    while at > 0 and value[at - 1] < f:
                        value[at], octant[at] = value[at - 1], octant[at - 1]
                        at -= 1
                    value[at], octant[at] = f, a
                if lowest == highest:
                    continue
                mask = 0
                for a in range(n - 1):
                    mask |= 1 << octant[a]
                    if value[a] > value[a + 1] and per_mask[mask]:
                        # These octants are kept for value[a + 1] < threshold <= value[a].
                        steps[np.searchsorted(thresholds, value[a + 1], side="right")] += per_mask[
                            mask
                        ]
                        steps[np.searchsorted(thresholds, value[a], side="right")] -= per_mask[mask]
