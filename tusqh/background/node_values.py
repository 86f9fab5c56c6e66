"""The values of cells, edges and vertices of a background, as multiples of `RESOLUTION`."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.background.background_mesh import BackgroundMesh
from tusqh.grid import IntArray
from tusqh.sampling.doubled_grid import Multiples
from tusqh.topology.clamping import FULL


@dataclass(frozen=True)
class NodeValues:
    """One multiple of `tusqh.sampling.doubled_grid.RESOLUTION` for every node, int32.

    Parameters
    ----------
    cells
        Of the cells, shape (m,).
    edges
        Of the edges of hexes, shape (e,); shape (0,) in the plane.
    vertices
        Of the vertices, shape (n,).
    """

    cells: Multiples
    edges: Multiples
    vertices: Multiples

    def all(self) -> Multiples:
        """Return the values in the order cells, edges, vertices, which numbers the nodes."""
        return np.concatenate([self.cells, self.edges, self.vertices])


@dataclass(frozen=True)
class Around:
    """The lowest and highest cell around every edge or vertex, shape (k,) each.

    Parameters
    ----------
    lowest, highest
        Numbers of the cells; of equal ones, the cell with the lowest number.
    """

    lowest: NDArray[np.int32]
    highest: NDArray[np.int32]


def find_around(values: Multiples, parts: IntArray, n: int) -> Around:
    """Return the cells with the lowest and the highest value around every part.

    Parameters
    ----------
    values
        Values of the cells, shape (m,).
    parts
        Parts (edges or vertices) of every cell, shape (m, k).
    n
        Number of parts.

    Examples
    --------
    >>> around = find_around(np.array([5, 3], dtype=np.int32), np.array([[0, 1], [1, 2]]), 3)
    >>> around.lowest.tolist(), around.highest.tolist()
    ([0, 1, 1], [0, 0, 1])
    """
    found = Around(np.full(n, -1, dtype=np.int32), np.full(n, -1, dtype=np.int32))
    _find(values, parts, found.lowest, found.highest)
    return found


def clamp(background: BackgroundMesh, values: NodeValues) -> NodeValues:
    """Return the values in 0..`FULL`, edges and vertices clamped to the cells around them.

    An edge or vertex is then in when all cells around it are, and out when all are out.  On the
    rim its value is 0.

    Parameters
    ----------
    background
        The background.
    values
        Values of all nodes.

    Examples
    --------
    >>> points = np.array([[x, y] for x in range(3) for y in range(3)], dtype=float)
    >>> quads = np.array([[0, 3, 4, 1], [1, 4, 5, 2], [3, 6, 7, 4], [4, 7, 8, 5]])
    >>> cells, vertices = np.array([4, 2, 2, 4], dtype=np.int32), np.full(9, 7, dtype=np.int32)
    >>> nodes = NodeValues(cells, np.zeros(0, dtype=np.int32), vertices)
    >>> clamp(BackgroundMesh(points, quads), nodes).vertices.tolist()
    [0, 0, 0, 0, 4, 0, 0, 0, 0]
    """
    cells = np.clip(values.cells, 0, FULL).astype(np.int32)
    parts = ((values.edges, background.edge_of), (values.vertices, background.cells))
    is_rim = (background.is_rim_edge, background.is_rim_vertex)
    clamped = []
    for (own, of_cells), on_rim in zip(parts, is_rim, strict=True):
        around = find_around(cells, of_cells, len(own))
        held = np.clip(own, cells[around.lowest], cells[around.highest]) if len(own) else own
        clamped.append(np.where(on_rim, 0, held).astype(np.int32))
    return NodeValues(cells, *clamped)


@numba.njit(cache=True)
def _find(values, parts, lowest, highest):  # type: ignore[no-untyped-def]
    for cell in range(len(parts)):
        for part in parts[cell]:
            if lowest[part] < 0 or values[cell] < values[lowest[part]]:
                lowest[part] = cell
            if highest[part] < 0 or values[cell] > values[highest[part]]:
                highest[part] = cell
