"""Compiled kernels: how components of the filtration merge, and how many simplices enter when.

Everything works on *keys*, the fractions as integer multiples of `RESOLUTION` in 0..`TOP` on the
doubled grid; a node is in at key ``k`` when its own key is at least ``k``, and keys of 0 never are.

Components need no nodes but cells.  A clamped vertex (or edge) node never enters before the
largest cell around it, and a cell that has a larger neighbour across a side is joined to it as
soon as it enters.  So of all the joins that a vertex makes, only those between the *local maxima*
of the cells around it matter: `_find_links` lists these, and `merge_components` runs one
union-find over cells, sides and links in decreasing order.
"""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.grid import FloatArray, IntArray
from tusqh.sampling.doubled_grid import RESOLUTION

Keys = NDArray[np.int32]

#: Key of a full cell.
TOP = round(1 / RESOLUTION)


def to_keys(values: FloatArray) -> Keys:
    """Return fractions on the doubled grid as clamped keys, padded with one layer of empty cells.

    Fractions below 0 and above 1 count as 0 and 1: no threshold in (0, 1] tells them apart.

    Examples
    --------
    >>> fractions = np.zeros((3, 3))
    >>> fractions[1, 1] = 0.5
    >>> int(to_keys(fractions)[3, 3]) / TOP
    0.5
    """
    keys = np.zeros(tuple(n + 4 for n in values.shape), dtype=np.int32)
    inner = keys[(slice(2, -2),) * values.ndim]
    for index, layer in enumerate(values):  # By layers, to bound the memory of temporaries.
        inner[index] = np.rint(np.clip(layer, 0.0, 1.0) / RESOLUTION)
    if values.ndim == 2:
        _clamp_2d(keys)
    else:
        _clamp_3d(keys)
    return keys


def merge_components(keys: Keys) -> tuple[IntArray, IntArray, IntArray, IntArray]:
    """Return the pairs of H_0 by the elder rule, those that live over no key left out.

    Parameters
    ----------
    keys
        Clamped keys, see `to_keys`, or their complement in 1..`TOP` + 1.

    Returns
    -------
    birth, death
        Keys at which each component enters and merges into an older one; 0 for those that
        never merge.
    birth_place, death_place
        Flat places in `keys` of the cell and of the cell, edge or vertex that do it; -1 for
        those that never merge.  Of equally old components the one with the lower place is elder.
    """
    cells = np.ascontiguousarray(keys[(slice(1, None, 2),) * keys.ndim])
    find = _find_links_2d if keys.ndim == 2 else _find_links_3d
    nothing = np.empty((4, 0), dtype=np.int32)
    links = np.empty((4, find(keys, nothing)), dtype=np.int32)
    find(keys, links)
    shape = np.array(cells.shape, dtype=np.int64)
    link_order = np.argsort(-links[0], kind="stable").astype(np.int32)
    born, died, born_cell, died_place = _union_find(
        cells.ravel(), shape, _order(cells.ravel()), links, link_order
    )
    doubled = tuple(2 * i + 1 for i in np.unravel_index(born_cell, cells.shape))
    birth_place = np.ravel_multi_index(doubled, keys.shape).astype(np.int64)
    of_cell = died_place < -1  # Places of cells are coded as -2 - cell.
    doubled = tuple(2 * i + 1 for i in np.unravel_index(-2 - died_place[of_cell], cells.shape))
    died_place[of_cell] = np.ravel_multi_index(doubled, keys.shape)
    return born, died, birth_place, died_place


def count_euler(keys: Keys) -> IntArray:
    """Return by how much the Euler characteristic grows at each key, shape (TOP + 1,)."""
    change = np.zeros(TOP + 1, dtype=np.int64)
    if keys.ndim == 2:
        _count_2d(keys, change)
    else:
        _count_3d(keys, change)
    return change


@numba.njit(cache=True)
def _order(cells):  # type: ignore[no-untyped-def]
    """Return the cells with keys above 0, largest key first (a counting sort)."""
    start = np.zeros(TOP + 3, dtype=np.int64)
    for key in cells:
        start[TOP + 2 - key] += 1
    n = len(cells) - start[TOP + 2]
    start = np.cumsum(start)
    order = np.empty(n, dtype=np.int32)
    for cell in range(len(cells)):
        if cells[cell] > 0:
            at = TOP + 1 - cells[cell]
            order[start[at]] = cell
            start[at] += 1
    return order


@numba.njit(cache=True)
def _root(parent, cell):  # type: ignore[no-untyped-def]
    while parent[cell] != cell:
        parent[cell] = parent[parent[cell]]
        cell = parent[cell]
    return cell


@numba.njit(cache=True)
def _union_find(cells, shape, order, links, link_order):  # type: ignore[no-untyped-def]
    """Return birth key, death key, birth cell and death place of every component."""
    dim = len(shape)
    stride = np.ones(dim, dtype=np.int64)
    for axis in range(dim - 2, -1, -1):
        stride[axis] = stride[axis + 1] * shape[axis + 1]
    parent = np.full(len(cells), -1, dtype=np.int32)
    # One column per pair; pairs that live over no key are left out.
    found = np.empty((4, 1024), dtype=np.int64)
    n_found = 0
    at_link = 0
    for step in range(len(order) + 1):
        key = cells[order[step]] if step < len(order) else 0
        while at_link < len(link_order) and links[0, link_order[at_link]] > key:
            link = link_order[at_link]
            at_link += 1
            level = links[0, link]
            a, b = _root(parent, links[1, link]), _root(parent, links[2, link])
            if a != b:
                if cells[a] < cells[b] or (cells[a] == cells[b] and a > b):
                    a, b = b, a
                parent[b] = a
                if cells[b] != level:
                    found = _with_room(found, n_found)
                    found[0, n_found], found[1, n_found] = cells[b], level
                    found[2, n_found], found[3, n_found] = b, links[3, link]
                    n_found += 1
        if step == len(order):
            break
        cell = order[step]
        parent[cell] = cell
        for axis in range(dim):
            index = cell // stride[axis] % shape[axis]
            for sign in (-1, 1):
                if not 0 <= index + sign < shape[axis]:
                    continue
                other = cell + sign * stride[axis]
                if parent[other] < 0:
                    continue
                a, b = _root(parent, cell), _root(parent, other)
                if a != b:
                    if cells[a] < cells[b] or (cells[a] == cells[b] and a > b):
                        a, b = b, a
                    parent[b] = a
                    if cells[b] != key:
                        found = _with_room(found, n_found)
                        found[0, n_found], found[1, n_found] = cells[b], key
                        found[2, n_found], found[3, n_found] = b, -2 - cell
                        n_found += 1
    for cell in order:
        if parent[cell] == cell:
            found = _with_room(found, n_found)
            found[0, n_found], found[1, n_found] = cells[cell], 0
            found[2, n_found], found[3, n_found] = cell, -1
            n_found += 1
    return found[:, :n_found]


@numba.njit(cache=True)
def _with_room(found, n_found):  # type: ignore[no-untyped-def]
    """Return the table with at least one free column."""
    if n_found < found.shape[1]:
        return found
    longer = np.empty((found.shape[0], 2 * found.shape[1]), dtype=np.int64)
    longer[:, :n_found] = found
    return longer


@numba.njit(cache=True)
def _emit(keys_around, numbers, neighbours, level, place, links, n):  # type: ignore[no-untyped-def]
    """List the links from the largest cell around a place to the other local maxima."""
    m = len(keys_around)
    top = 0
    for a in range(1, m):
        if keys_around[a] > keys_around[top]:
            top = a
    for a in range(m):
        joined = min(level, keys_around[a])
        if a == top or joined == 0:
            continue
        is_local_maximum = True
        for b in neighbours[a]:
            # Of equals the earlier one counts as larger.
            if keys_around[b] > keys_around[a] or (keys_around[b] == keys_around[a] and b < a):
                is_local_maximum = False
        if is_local_maximum:
            if links.shape[1] > 0:
                links[0, n] = joined
                links[1, n] = numbers[a]
                links[2, n] = numbers[top]
                links[3, n] = place if level <= keys_around[a] else -2 - numbers[a]
            n += 1
    return n


#: Neighbours across sides among the four cells around an edge (or 2D vertex), bits = axes.
_AROUND_4 = np.array([[1, 2], [0, 3], [0, 3], [1, 2]])
#: The same among the eight cells around a vertex.
_AROUND_8 = np.array([[c ^ 1, c ^ 2, c ^ 4] for c in range(8)])


@numba.njit(cache=True)
def _find_links_2d(keys, links):  # type: ignore[no-untyped-def]
    n_y = keys.shape[1] // 2
    around, numbers = np.empty(4, dtype=np.int64), np.empty(4, dtype=np.int64)
    n = 0
    for i in range(2, keys.shape[0] - 2, 2):
        for j in range(2, keys.shape[1] - 2, 2):
            for c in range(4):
                x, y = i - 1 + 2 * (c & 1), j - 1 + (c & 2)
                around[c] = keys[x, y]
                numbers[c] = (x // 2) * n_y + y // 2
            n = _emit(around, numbers, _AROUND_4, keys[i, j], i * keys.shape[1] + j, links, n)
    return n


@numba.njit(cache=True)
def _find_links_3d(keys, links):  # type: ignore[no-untyped-def]
    n_x, n_y, n_z = keys.shape
    four, four_numbers = np.empty(4, dtype=np.int64), np.empty(4, dtype=np.int64)
    eight, eight_numbers = np.empty(8, dtype=np.int64), np.empty(8, dtype=np.int64)
    n = 0
    for i in range(1, n_x - 1):
        for j in range(1, n_y - 1):
            for k in range(1, n_z - 1):
                odd = i % 2 + j % 2 + k % 2
                if odd > 1:
                    continue
                place = (i * n_y + j) * n_z + k
                if odd == 1:
                    for c in range(4):
                        low, high = c & 1, c >> 1
                        if i % 2:
                            x, y, z = i, j - 1 + 2 * low, k - 1 + 2 * high
                        elif j % 2:
                            x, y, z = i - 1 + 2 * low, j, k - 1 + 2 * high
                        else:
                            x, y, z = i - 1 + 2 * low, j - 1 + 2 * high, k
                        four[c] = keys[x, y, z]
                        four_numbers[c] = ((x // 2) * (n_y // 2) + y // 2) * (n_z // 2) + z // 2
                    n = _emit(four, four_numbers, _AROUND_4, keys[i, j, k], place, links, n)
                else:
                    for c in range(8):
                        x, y, z = i - 1 + 2 * (c & 1), j - 1 + (c & 2), k - 1 + 2 * (c >> 2)
                        eight[c] = keys[x, y, z]
                        eight_numbers[c] = ((x // 2) * (n_y // 2) + y // 2) * (n_z // 2) + z // 2
                    n = _emit(eight, eight_numbers, _AROUND_8, keys[i, j, k], place, links, n)
    return n


@numba.njit(cache=True)
def _clamp_2d(keys):  # type: ignore[no-untyped-def]
    for i in range(2, keys.shape[0] - 2, 2):
        for j in range(2, keys.shape[1] - 2, 2):
            low, high = TOP, 0
            for c in range(4):
                key = keys[i - 1 + 2 * (c & 1), j - 1 + (c & 2)]
                low, high = min(low, key), max(high, key)
            keys[i, j] = min(max(keys[i, j], low), high)


@numba.njit(cache=True)
def _clamp_3d(keys):  # type: ignore[no-untyped-def]
    n_x, n_y, n_z = keys.shape
    for odd in (1, 0):  # Edges first: vertices are clamped to clamped edges.
        for i in range(1, n_x - 1):
            for j in range(1, n_y - 1):
                for k in range(1, n_z - 1):
                    if i % 2 + j % 2 + k % 2 != odd:
                        continue
                    low, high = TOP, 0
                    for c in range(8):
                        x = i if i % 2 else i - 1 + 2 * (c & 1)
                        y = j if j % 2 else j - 1 + (c & 2)
                        z = k if k % 2 else k - 1 + 2 * (c >> 2)
                        key = keys[x, y, z]
                        low, high = min(low, key), max(high, key)
                    # Clamped edges lie within the range of their cells, so the cells decide.
                    keys[i, j, k] = min(max(keys[i, j, k], low), high)


@numba.njit(cache=True)
def _count_2d(keys, change):  # type: ignore[no-untyped-def]
    n_x, n_y = keys.shape
    for i in range(1, n_x - 1):
        for j in range(1, n_y - 1):
            if i % 2 and j % 2:
                change[keys[i, j]] += 1
            elif i % 2:
                change[min(keys[i, j - 1], keys[i, j + 1])] -= 1
            elif j % 2:
                change[min(keys[i - 1, j], keys[i + 1, j])] -= 1
            else:
                v = keys[i, j]
                a = min(v, keys[i - 1, j - 1])
                b = min(v, keys[i + 1, j - 1])
                c = min(v, keys[i + 1, j + 1])
                d = min(v, keys[i - 1, j + 1])
                change[v] += 1
                change[a] -= 1
                change[b] -= 1
                change[c] -= 1
                change[d] -= 1
                change[min(a, b)] += 1
                change[min(b, c)] += 1
                change[min(c, d)] += 1
                change[min(d, a)] += 1


@numba.njit(cache=True)
def _count_3d(keys, change):  # type: ignore[no-untyped-def]
    n_x, n_y, n_z = keys.shape
    cell = np.empty((2, 2, 2), dtype=np.int64)
    for i in range(1, n_x - 1):
        for j in range(1, n_y - 1):
            for k in range(1, n_z - 1):
                odd = i % 2 + j % 2 + k % 2
                e = keys[i, j, k]
                if odd == 3:
                    change[e] += 1
                elif odd == 2:
                    x, y, z = 1 - i % 2, 1 - j % 2, 1 - k % 2
                    change[min(keys[i - x, j - y, k - z], keys[i + x, j + y, k + z])] -= 1
                elif odd == 1:
                    if e == 0:
                        continue
                    if i % 2:
                        a, b = keys[i, j - 1, k - 1], keys[i, j + 1, k - 1]
                        c, d = keys[i, j + 1, k + 1], keys[i, j - 1, k + 1]
                    elif j % 2:
                        a, b = keys[i - 1, j, k - 1], keys[i + 1, j, k - 1]
                        c, d = keys[i + 1, j, k + 1], keys[i - 1, j, k + 1]
                    else:
                        a, b = keys[i - 1, j - 1, k], keys[i + 1, j - 1, k]
                        c, d = keys[i + 1, j + 1, k], keys[i - 1, j + 1, k]
                    a, b, c, d = min(a, e), min(b, e), min(c, e), min(d, e)
                    change[e] += 1
                    change[a] -= 1
                    change[b] -= 1
                    change[c] -= 1
                    change[d] -= 1
                    change[min(a, b)] += 1
                    change[min(b, c)] += 1
                    change[min(c, d)] += 1
                    change[min(d, a)] += 1
                elif e > 0:
                    low, high = TOP, 0
                    for x in range(2):
                        for y in range(2):
                            for z in range(2):
                                h = keys[i - 1 + 2 * x, j - 1 + 2 * y, k - 1 + 2 * z]
                                low, high = min(low, h), max(high, h)
                                cell[x, y, z] = min(e, h)
                    if low == high:  # The link is a sphere that enters all at once.
                        change[e] -= 1
                        continue
                    change[e] += 1
                    for x in range(2):
                        for y in range(2):
                            for z in range(2):
                                h = cell[x, y, z]
                                change[h] -= 1
                                if x == 0:
                                    change[min(h, cell[1, y, z])] += 1
                                if y == 0:
                                    change[min(h, cell[x, 1, z])] += 1
                                if z == 0:
                                    change[min(h, cell[x, y, 1])] += 1
                    for axis in range(3):
                        for side in range(2):
                            step = 2 * side - 1
                            if axis == 0:
                                edge = keys[i + step, j, k]
                                a, b = cell[side, 0, 0], cell[side, 1, 0]
                                c, d = cell[side, 1, 1], cell[side, 0, 1]
                            elif axis == 1:
                                edge = keys[i, j + step, k]
                                a, b = cell[0, side, 0], cell[1, side, 0]
                                c, d = cell[1, side, 1], cell[0, side, 1]
                            else:
                                edge = keys[i, j, k + step]
                                a, b = cell[0, 0, side], cell[1, 0, side]
                                c, d = cell[1, 1, side], cell[0, 1, side]
                            edge = min(edge, e)
                            a, b, c, d = min(a, edge), min(b, edge), min(c, edge), min(d, edge)
                            change[edge] -= 1
                            change[a] += 1
                            change[b] += 1
                            change[c] += 1
                            change[d] += 1
                            change[min(a, b)] -= 1
                            change[min(b, c)] -= 1
                            change[min(c, d)] -= 1
                            change[min(d, a)] -= 1
