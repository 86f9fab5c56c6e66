"""Label the components of a mesh: by the points or by the parts that elements share."""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.grid import IndexArray

Labels = NDArray[np.int32]


def label_points(cells: IndexArray, n_points: int) -> tuple[Labels, int]:
    """Return the component of every point, and their number; elements join their points.

    Parameters
    ----------
    cells
        Points of every element, shape (m, k).
    n_points
        Number of points; each that no element uses is a component of its own.

    Returns
    -------
    labels
        Component of every point, from 0, shape (n_points,).
    n
        Number of components.

    Examples
    --------
    >>> labels, n = label_points(np.array([[0, 1], [1, 2], [3, 4]]), 5)
    >>> labels.tolist(), n
    ([0, 0, 0, 1, 1], 2)
    """
    parent = np.arange(n_points, dtype=np.int32)
    _join_rows(cells, parent)
    return parent, int(_number(parent))


def label_elements(numbers: IndexArray, n_local: int) -> tuple[Labels, int]:
    """Return the component of every element, and their number; equal parts join elements.

    Parameters
    ----------
    numbers
        Number of every part of every element, see `tusqh.meshes.numbering.number_rows`.
    n_local
        Number of parts of an element.

    Returns
    -------
    labels
        Component of every element, from 0, shape (m,).
    n
        Number of components.

    Examples
    --------
    >>> labels, n = label_elements(np.array([0, 1, 1, 2, 3, 4]), 2)
    >>> labels.tolist(), n
    ([0, 0, 1], 2)
    """
    n_parts = int(numbers.max(initial=-1)) + 1
    parent = np.arange(len(numbers) // n_local, dtype=np.int32)
    _join_by_parts(numbers, n_local, np.full(n_parts, -1, dtype=np.int32), parent)
    return parent, int(_number(parent))


@numba.njit(cache=True)
def _root(parent, at):  # type: ignore[no-untyped-def]
    while parent[at] != at:
        parent[at] = parent[parent[at]]
        at = parent[at]
    return at


@numba.njit(cache=True)
def _join_rows(cells, parent):  # type: ignore[no-untyped-def]
    """Join the points of each element to the lowest one."""
    for row in cells:
        for point in row:
            a, b = _root(parent, row[0]), _root(parent, point)
            if a != b:
                parent[max(a, b)] = min(a, b)


@numba.njit(cache=True)
def _join_by_parts(numbers, n_local, holder, parent):  # type: ignore[no-untyped-def]
    """Join each element to the first one that has the same part."""
    for row in range(len(numbers)):
        part, cell = numbers[row], row // n_local
        if holder[part] < 0:
            holder[part] = cell
            continue
        a, b = _root(parent, holder[part]), _root(parent, cell)
        if a != b:
            parent[max(a, b)] = min(a, b)


@numba.njit(cache=True)
def _number(parent):  # type: ignore[no-untyped-def]
    """Replace parents, which are never higher, by numbers of components, and return how many."""
    n = 0
    for at in range(len(parent)):
        if parent[at] == at:
            parent[at] = n
            n += 1
        else:
            parent[at] = parent[parent[at]]
    return n
