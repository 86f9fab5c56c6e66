"""Find where components that nothing joins come nearest to one another."""

from __future__ import annotations

import numpy as np

from tusqh.antialias.components import label_kept
from tusqh.contacts.one_material_contacts import find_contacts, label_cells
from tusqh.grid import FloatArray, IntArray, doubled
from tusqh.sampling.doubled_grid import Multiples


def find_joints(multiples: Multiples, oldest: IntArray) -> IntArray:
    """Return the cells at which components meet when empty cells are filled, the nearest first.

    Parameters
    ----------
    multiples
        Fractions on the doubled grid, shape ``2 n + 1``, int32.
    oldest
        Places of the cells with which the components of all cells above 0 begin, the oldest
        component first, shape (r,).

    Returns
    -------
    places
        Of every component but the first, the cell at which an older one joins it, as a flat place,
        shape (r - 1,).

    Examples
    --------
    >>> multiples = np.zeros((3, 15), dtype=np.int32)
    >>> multiples[1, [1, 9, 13]] = [3, 2, 1]
    >>> [place % 15 // 2 for place in find_joints(multiples, np.array([16, 24, 28])).tolist()]
    [2, 5]
    """
    from scipy import ndimage

    kept = multiples[doubled.cells(multiples.ndim)] > 0
    component = label_kept(label_cells(kept), find_contacts(kept, multiples > 0))
    distance, nearest = ndimage.distance_transform_edt(~kept, return_indices=True)
    first, second, length, place = _find_borders(component[tuple(nearest)], distance)
    at = tuple(i // 2 for i in np.unravel_index(oldest, multiples.shape))
    parent = {int(name): age for age, name in enumerate(component[at].tolist())}
    elder = list(range(len(oldest)))
    found = np.full(len(oldest), -1, dtype=np.int64)
    for k in np.lexsort((place, length)).tolist():
        a, b = (_root(elder, parent[int(side[k])]) for side in (first, second))
        if a != b:
            elder[max(a, b)] = min(a, b)
            found[max(a, b)] = place[k]
    index = np.unravel_index(found[1:], kept.shape)
    return np.asarray(
        np.ravel_multi_index(tuple(2 * i + 1 for i in index), multiples.shape), dtype=np.int64
    )


def _find_borders(
    names: IntArray, distance: FloatArray
) -> tuple[IntArray, IntArray, FloatArray, IntArray]:
    """Return all pairs of components whose cells meet, at what distance first, and in which cell.

    Every cell has the name of the component nearest to it.
    """
    flat = np.arange(names.size).reshape(names.shape)
    parts = []
    for axis in range(names.ndim):
        low, high = (
            tuple(cut if k == axis else slice(None) for k in range(names.ndim))
            for cut in (slice(None, -1), slice(1, None))
        )
        meets = names[low] != names[high]
        sides = [[array[side][meets] for side in (low, high)] for array in (names, distance, flat)]
        cell = np.where(sides[1][0] >= sides[1][1], *sides[2])
        parts.append([np.minimum(*sides[0]), np.maximum(*sides[0]), np.maximum(*sides[1]), cell])
    first, second, length, cell = map(np.concatenate, zip(*parts, strict=True))
    order = np.lexsort((cell, length, second, first))
    pairs, length_of = np.stack([first, second])[:, order], length[order]
    is_new = np.append(True, (pairs[:, 1:] != pairs[:, :-1]).any(axis=0))[: len(order)]
    starts = np.flatnonzero(is_new | np.append(True, np.diff(length_of) != 0)[: len(order)])
    n_alike = np.diff(np.append(starts, len(order)))
    # Of the cells at the shortest distance, the middle one.
    chosen = order[(starts + n_alike // 2)[is_new[starts]]]
    return first[chosen], second[chosen], length[chosen], cell[chosen]


def _root(elder: list[int], at: int) -> int:
    """Return the oldest component to which one is joined."""
    while elder[at] != at:
        at = elder[at]
    return at
