"""Find links: the joins between cells that edges and vertices make.

Cells are the only nodes that the components of the filtration need.  A clamped vertex (or edge)
never appears before the largest cell around it, and a cell with a larger neighbour across a face is
joined to it as soon as it appears.  So of all the joins that a vertex makes, only those between the
*local maxima* among the cells around it matter: each local maximum is linked to the largest one.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.grid.doubled import as_layer
from tusqh.sampling.doubled_grid import Multiples

#: Numbers of the neighbours across faces of the four cells around an edge; bits are axes.
_AROUND_EDGE = np.array([[c ^ 1, c ^ 2] for c in range(4)])
#: The same for the eight cells around a vertex.
_AROUND_VERTEX = np.array([[c ^ 1, c ^ 2, c ^ 4] for c in range(8)])


class Links(NamedTuple):
    """Joins between cells, in the order of their places; all arrays are int32 of shape (m,).

    Parameters
    ----------
    level
        Multiple at which the two cells are joined.
    cell, other
        Flat numbers of the cells.
    place
        Flat place on the doubled grid of the node that appears last and joins them: the edge or
        vertex, or `cell`.
    """

    level: NDArray[np.int32]
    cell: NDArray[np.int32]
    other: NDArray[np.int32]
    place: NDArray[np.int32]


def find_links(nodes: Multiples) -> Links:
    """Return the links at all interior edges and vertices.

    Parameters
    ----------
    nodes
        Multiples of all nodes, see `tusqh.topology.clamping.clamp_multiples`, or their
        complement; flat places belong to this array, and cells are numbered in C order.
    """
    layer = as_layer(nodes)
    table = np.empty((4, _list_links(layer, np.empty((4, 0), dtype=np.int32))), dtype=np.int32)
    _list_links(layer, table)
    if nodes.ndim == 2:
        table[3] -= nodes.size  # Index 1 along the layer's first axis becomes 0.
    return Links(*table)


@numba.njit(cache=True)
def _list_links(nodes, links):  # type: ignore[no-untyped-def]
    """Write the links, one column each, if there is room for them, and return their number."""
    n_x, n_y, n_z = nodes.shape
    # The rows are the multiple, number and place of each cell around a place.
    around = np.empty((3, 8), dtype=np.int64)
    n = 0
    for i in range(1, n_x - 1):
        for j in range(1, n_y - 1):
            for k in range(1, n_z - 1):
                odd_i, odd_j, odd_k = i % 2, j % 2, k % 2
                if odd_i + odd_j + odd_k > 1:
                    continue
                low, high = nodes[i - 1 + odd_i, j - 1 + odd_j, k - 1 + odd_k], 0
                for x in range(i - 1 + odd_i, i + 2 - odd_i, 2):
                    for y in range(j - 1 + odd_j, j + 2 - odd_j, 2):
                        for z in range(k - 1 + odd_k, k + 2 - odd_k, 2):
                            low, high = min(low, nodes[x, y, z]), max(high, nodes[x, y, z])
                if low == high or nodes[i, j, k] == 0:  # There is one local maximum, or no node.
                    continue
                m = 0
                for z in range(k - 1 + odd_k, k + 2 - odd_k, 2):
                    for y in range(j - 1 + odd_j, j + 2 - odd_j, 2):
                        for x in range(i - 1 + odd_i, i + 2 - odd_i, 2):
                            around[0, m] = nodes[x, y, z]
                            around[1, m] = (x // 2 * (n_y // 2) + y // 2) * (n_z // 2) + z // 2
                            around[2, m] = (x * n_y + y) * n_z + z
                            m += 1
                neighbours = _AROUND_EDGE if m == 4 else _AROUND_VERTEX
                place = (i * n_y + j) * n_z + k
                n = _link(around[:, :m], neighbours, nodes[i, j, k], place, links, n)
    return n


@numba.njit(cache=True)
def _link(around, neighbours, multiple, place, links, n):  # type: ignore[no-untyped-def]
    """Link the local maxima around a place to the largest one, and return the number of links."""
    multiples = around[0]
    top = 0
    for a in range(1, len(multiples)):
        if multiples[a] > multiples[top]:
            top = a
    for a in range(len(multiples)):
        level = min(multiple, multiples[a])
        if a == top or level == 0:
            continue
        is_local_maximum = True
        for b in neighbours[a]:
            # If two cells are equal, the earlier one counts as larger.
            if multiples[b] > multiples[a] or (multiples[b] == multiples[a] and b < a):
                is_local_maximum = False
        if is_local_maximum:
            if links.shape[1] > 0:
                links[0, n] = level
                links[1, n], links[2, n] = around[1, a], around[1, top]
                links[3, n] = place if multiple <= multiples[a] else around[2, a]
            n += 1
    return n
