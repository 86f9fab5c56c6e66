"""Count the Betti numbers of the filtration at one level, without those of the other levels.

At one level the nodes are in or out.  An edge or vertex that is in joins the cells around it that
are in, and one that is out joins those that are out; cells of one kind are joined across faces.
The components of the first kind are those of the complex, and the components of the second kind are
its voids (in 2D its holes) and the outside.  In 3D the holes follow from the Euler characteristic.
"""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.grid.doubled import as_layer
from tusqh.sampling.doubled_grid import Multiples
from tusqh.topology.betti_numbers import BettiNumbers
from tusqh.topology.euler_count import count_euler_at


def count_at_level(nodes: Multiples | NDArray[np.uint8], level: int) -> BettiNumbers:
    """Return the Betti numbers of the nodes whose multiples are at least a level.

    Parameters
    ----------
    nodes
        Multiples of all nodes, see `tusqh.topology.clamping.clamp_multiples`.
    level
        Positive multiple of `tusqh.sampling.doubled_grid.RESOLUTION`.

    Examples
    --------
    >>> from tusqh.topology.clamping import clamp_multiples
    >>> multiples = np.zeros((7, 7), dtype=np.int32)
    >>> multiples[1::2, 1::2] = 4
    >>> multiples[3, 3] = 2
    >>> [str(count_at_level(clamp_multiples(multiples), level)) for level in (2, 3)]
    ['(1, 0, 0)', '(1, 1, 0)']
    """
    layer = as_layer(nodes)
    cells = np.ascontiguousarray(layer[1::2, 1::2, 1::2]) >= level
    n_in, n_out = _count_components(layer, level, cells, np.arange(cells.size, dtype=np.int32))
    if nodes.ndim == 2:
        return BettiNumbers(int(n_in), int(n_out) - 1)
    euler = count_euler_at(nodes, level)
    return BettiNumbers(int(n_in), int(n_in + n_out) - 1 - euler, int(n_out) - 1)


@numba.njit(cache=True)
def _root(parent, cell):  # type: ignore[no-untyped-def]
    while parent[cell] != cell:
        parent[cell] = parent[parent[cell]]
        cell = parent[cell]
    return cell


@numba.njit(cache=True)
def _count_components(nodes, level, cells, parent):  # type: ignore[no-untyped-def]
    """Return the numbers of components of the cells that are in and of those that are out."""
    counts = np.array([0, 0])
    m_x, m_y, m_z = cells.shape
    for i in range(m_x):
        for j in range(m_y):
            for k in range(m_z):
                is_in, cell = cells[i, j, k], (i * m_y + j) * m_z + k
                counts[1 - is_in] += 1
                if i > 0 and cells[i - 1, j, k] == is_in:
                    counts[1 - is_in] -= _join(parent, cell, cell - m_y * m_z)
                if j > 0 and cells[i, j - 1, k] == is_in:
                    counts[1 - is_in] -= _join(parent, cell, cell - m_z)
                if k > 0 and cells[i, j, k - 1] == is_in:
                    counts[1 - is_in] -= _join(parent, cell, cell - 1)
    n_x, n_y, n_z = nodes.shape
    for i in range(1, n_x - 1):
        for j in range(1, n_y - 1):
            x_from, x_to = i // 2 - 1 + i % 2, i // 2 + 1
            y_from, y_to = j // 2 - 1 + j % 2, j // 2 + 1
            for k in range(1, n_z - 1):
                if i % 2 + j % 2 + k % 2 > 1:
                    continue
                z_from, z_to = k // 2 - 1 + k % 2, k // 2 + 1
                has_in = has_out = False
                for x in range(x_from, x_to):
                    for y in range(y_from, y_to):
                        for z in range(z_from, z_to):
                            has_in |= cells[x, y, z]
                            has_out |= not cells[x, y, z]
                if not (has_in and has_out):  # Joined across faces.
                    continue
                is_in, first = nodes[i, j, k] >= level, -1
                for x in range(x_from, x_to):
                    for y in range(y_from, y_to):
                        for z in range(z_from, z_to):
                            if cells[x, y, z] != is_in:
                                continue
                            cell = (x * m_y + y) * m_z + z
                            if first >= 0:
                                counts[1 - is_in] -= _join(parent, first, cell)
                            first = cell
    return counts[0], counts[1]


@numba.njit(cache=True)
def _join(parent, a, b):  # type: ignore[no-untyped-def]
    """Join two components, and return 1 if they were different."""
    a, b = _root(parent, a), _root(parent, b)
    parent[max(a, b)] = min(a, b)
    return int(a != b)
