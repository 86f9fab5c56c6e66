r"""Emit strips along the paths of bridges: two quads per edge, half a cell wide.

A strip is mitred at turns; at its ends it widens to the corners of inner cells, where the
trapezoids that attach it begin (algorithm 5)::

    kept |  \___________/  | kept      v: ends of the path
    -----v-----path------v-----
    kept |  /           \  | kept
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tusqh.contacts.emitter import Emitter
from tusqh.contacts.templates import INSET
from tusqh.grid.arrays import BoolArray, IntArray
from tusqh.grid.numbering import FACES, QUAD_CORNERS
from tusqh.meshes.volume_mesh import BRIDGE

#: Directions of the points beside a straight path, in units of `INSET`.
_STUBS: IntArray = np.array([[1, 0], [0, 1], [-1, 0], [0, -1]], dtype=np.int64)


@dataclass(frozen=True)
class Strip:
    """The two sides of a path of grid edges.

    Parameters
    ----------
    path
        Grid vertices, shape (m, 2).
    sides
        Offsets from the vertices to the points to the left and to the right, in units of `INSET`,
        shape (m, 2) each.
    beside
        Cells to the left and to the right of every edge, shape (m - 1, 2) each.
    """

    path: IntArray
    sides: tuple[IntArray, IntArray]
    beside: tuple[IntArray, IntArray]

    @classmethod
    def along(cls, path: IntArray) -> Strip:
        """Return the strip along a path of grid vertices, shape (m, 2).

        Parameters
        ----------
        path
            Grid vertices, each adjacent to the previous one, shape (m, 2).
        """
        steps = np.diff(path, axis=0)
        left = np.stack([-steps[:, 1], steps[:, 0]], axis=1)
        at_left = np.empty_like(path)
        turns = (steps[:-1] != steps[1:]).any(axis=1)[:, None]
        at_left[1:-1] = np.where(turns, left[:-1] + left[1:], left[1:])
        at_left[0], at_left[-1] = left[0] + steps[0], left[-1] - steps[-1]
        at_right = -at_left
        at_right[0], at_right[-1] = steps[0] - left[0], -left[-1] - steps[-1]
        to_left, to_right = (path[:-1] + (steps + across - 1) // 2 for across in (left, -left))
        return cls(path, (at_left, at_right), (to_left, to_right))


def find_cells_with_corners(strips: Sequence[Strip], shape: tuple[int, ...]) -> BoolArray:
    """Return the cells whose inner corners are points of strips, shape n.

    Parameters
    ----------
    strips
        Strips along paths.
    shape
        Shape n of the grid.
    """
    found = np.zeros(shape, dtype=bool)
    for strip in strips:
        for side in strip.sides:
            is_corner = (side != 0).all(axis=1)
            found[tuple((strip.path + (side - 1) // 2)[is_corner].T)] = True
    return found


def find_attached_sides(strips: Sequence[Strip], shape: tuple[int, ...]) -> BoolArray:
    """Return for every side number the cells with a trapezoid there that attaches a strip.

    The shape is (4, *n), with sides in the order of `tusqh.grid.numbering.FACES`.

    Parameters
    ----------
    strips
        Strips along paths.
    shape
        Shape n of the grid.
    """
    attaches = np.zeros((4, *shape), dtype=bool)
    for strip in strips:
        for end, towards in (
            (0, strip.path[0] - strip.path[1]),
            (-1, strip.path[-1] - strip.path[-2]),
        ):
            axis = int(np.flatnonzero(towards)[0])
            side = FACES[2].index((axis, int(towards[axis] > 0)))
            for beside in strip.beside:
                attaches[(side, *beside[end])] = True
    return attaches


def emit_strips(emitter: Emitter, strips: Sequence[Strip]) -> None:
    """Add the quads of strips to an emitter whose cells have the required inner corners.

    Parameters
    ----------
    emitter
        The emitter to which points and elements are added.
    strips
        Strips along paths.
    """
    if not strips:
        return
    stubs = np.concatenate([_stubs(emitter, s.path, side)[0] for s in strips for side in s.sides])
    codes = np.unique(stubs)
    vertex, direction = np.divmod(codes, 4)
    at = np.stack(np.unravel_index(vertex, emitter.vertex_shape), axis=1)
    first = emitter.add_points(at + INSET * _STUBS[direction])[:1]
    for strip in strips:
        vertex = np.ravel_multi_index(tuple(strip.path.T), emitter.vertex_shape)
        to_left, to_right = (
            _points(emitter, strip.path, side, codes, first) for side in strip.sides
        )
        quads = [
            np.stack([vertex[:-1], vertex[1:], to_left[1:], to_left[:-1]], axis=1),
            np.stack([vertex[1:], vertex[:-1], to_right[:-1], to_right[1:]], axis=1),
        ]
        for elements, beside in zip(quads, strip.beside, strict=True):
            owners = np.ravel_multi_index(tuple(beside.T), emitter.grid.shape)
            emitter.add(elements, owners.astype(np.int64), BRIDGE)


def _stubs(emitter: Emitter, path: IntArray, side: IntArray) -> tuple[IntArray, BoolArray]:
    """Return the codes (4 vertex + direction) of stub points, and a mask of their vertices."""
    is_stub = (side == 0).any(axis=1)
    vertex = np.ravel_multi_index(tuple(path[is_stub].T), emitter.vertex_shape)
    direction = (_STUBS[None] == side[is_stub][:, None]).all(axis=2).argmax(axis=1)
    return np.asarray(4 * vertex + direction, dtype=np.int64), is_stub


def _points(
    emitter: Emitter, path: IntArray, side: IntArray, codes: IntArray, first: IntArray
) -> IntArray:
    """Return the point numbers a quarter of a cell from vertices, along one axis or both."""
    points = np.empty(len(path), dtype=np.int64)
    stubs, is_stub = _stubs(emitter, path, side)
    points[is_stub] = np.searchsorted(codes, stubs)
    points[is_stub] += first
    diagonal = side[~is_stub]
    cells = np.ravel_multi_index(
        tuple((path[~is_stub] + (diagonal - 1) // 2).T), emitter.grid.shape
    )
    corner = (QUAD_CORNERS[None] == (diagonal[:, None] < 0)).all(axis=2).argmax(axis=1)
    points[~is_stub] = emitter.inner(np.asarray(cells))[np.arange(len(corner)), corner]
    return points
