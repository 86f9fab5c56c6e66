r"""The 2-6 template between two split cells of a 3D grid (algorithm 4.3).

If two split acting cells share a face that touches a decided vertex, their two frusta are replaced
by two centres, between the inner cells and a small quad in the face, and by four rings around that
quad, one per edge of the face.  Separating keeps the centres and the rings without a decided
vertex; connecting adds the rings with a decided vertex.

This section cuts a face between two split cells; ``f`` are its edges, ``s`` is the small quad::

    +-----------f-----------+
    | \  ring  / \  ring  / |
    |  +------+   +------+  |
    |  |inner |ctr|inner |  |
    |  +------s---s------+  |
    | /        \ /        \ |
    +-----------f-----------+
"""

from __future__ import annotations

import numpy as np

from tusqh.antialias.actions import Action
from tusqh.antialias.clusters import SEPARATE
from tusqh.contacts.emitter import Emitter
from tusqh.grid.arrays import IntArray
from tusqh.grid.neighbourhoods import neighbours_along
from tusqh.grid.numbering import FACES, HEX_CORNERS

#: Distance of the small quad from the edges of its face, in cells.  On cubic cells the scaled
#: Jacobian of rings is at least 2/3, that of centres 0.9.
_QUAD_INSET = 0.35


def emit_rings(emitter: Emitter, action: Action, kind: int) -> None:
    """Add the 2-6 templates between acting cells to an emitter.

    Parameters
    ----------
    emitter
        The emitter to which points and elements are added; split acting cells have inner cells.
    action
        The action of one of the decisions.
    kind
        One of the kinds of `tusqh.meshes.volume_mesh`.
    """
    separates = action.decision == SEPARATE
    is_decided = action.at_vertex.ravel()
    for axis in range(3):
        face = FACES[3].index((axis, 1))
        local = emitter.template.facets[face]
        lower, upper = _find_pairs(action, axis, face)
        opposite = [_across(int(corner), axis) for corner in local]
        outer = emitter.outer(lower)[:, local]
        below, above = emitter.inner(lower)[:, local], emitter.inner(upper)[:, opposite]
        small = _add_small_quads(emitter, lower, axis, local)
        if separates:
            emitter.add(np.concatenate([below, small], axis=1), lower, kind)
            emitter.add(np.concatenate([small, above], axis=1), upper, kind)
        for a in range(4):
            b = (a + 1) % 4
            at_vertex = is_decided[outer[:, a]] | is_decided[outer[:, b]]
            chosen = ~at_vertex if separates else at_vertex
            ring = [quad[:, c] for c in (a, b) for quad in (outer, below, small, above)]
            emitter.add(np.stack(ring, axis=1)[chosen], lower[chosen], kind)


def _find_pairs(action: Action, axis: int, face: int) -> tuple[IntArray, IntArray]:
    """Return the flat cells on both sides of the faces, normal to an axis, with the template."""
    numbers = np.arange(action.kept.size, dtype=np.int64).reshape(action.kept.shape)
    lower, upper = neighbours_along(numbers, axis)
    acts_below, acts_above = neighbours_along(action.acting, axis)
    touched, _ = neighbours_along(action.touched[face], axis)
    chosen = acts_below & acts_above & touched
    return lower[chosen], upper[chosen]


def _add_small_quads(emitter: Emitter, lower: IntArray, axis: int, local: IntArray) -> IntArray:
    """Return new points in the upper faces of cells, shape (m, 4)."""
    inset = _QUAD_INSET + (1 - 2 * _QUAD_INSET) * HEX_CORNERS[local]
    inset[:, axis] = 1.0
    lowest = np.stack(np.unravel_index(lower, emitter.grid.shape), axis=1)
    return emitter.add_points((lowest[:, None] + inset).reshape(-1, 3)).reshape(-1, 4)


def _across(corner: int, axis: int) -> int:
    """Return the corner of the next cell along an axis at the same grid vertex."""
    offset = HEX_CORNERS[corner].copy()
    offset[axis] = 1 - offset[axis]
    return int((offset == HEX_CORNERS).all(axis=1).argmax())
