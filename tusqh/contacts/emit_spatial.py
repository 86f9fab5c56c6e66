r"""Emit the hexes of cells and sticks: the 1-7 template in cells, the 2-6 template in faces.

This section cuts a refined face between two cells; ``f`` are its edges, ``s`` is the small quad::

    +-----------f-----------+
    | \  ring  / \  ring  / |      Inner cells, centres (ctr) and frusta have the material of
    |  +------+   +------+  |      their cell; a ring has that of the stick along its edge.
    |  |inner |ctr|inner |  |
    |  +------s---s------+  |
    | /        \ /        \ |
    +-----------f-----------+

A face whose four rings all have the material of one of its cells stays plain, and both frusta get
that material: the same bodies meet, with four hexes fewer.  A cell of one material with six plain
faces stays whole.  Faces on the sides of the grid are refined at balls only, see `side_balls`.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import NamedTuple

import numpy as np

from tusqh.contacts.ball_elements import Balls, RingEnd, ring_end
from tusqh.contacts.decided import Labels
from tusqh.contacts.emitter import Emitted, Emitter
from tusqh.contacts.side_balls import (
    INSET_ON_SIDE,
    SMALL_ON_SIDE,
    Slots,
    name_side_balls,
    slots_of_cell,
    slots_of_frustum,
)
from tusqh.contacts.spatial import SpatialDecision, face_sticks
from tusqh.grid import HEX_CORNERS, BackgroundGrid, BoolArray, IndexArray, IntArray
from tusqh.grid.numbering import FACES
from tusqh.meshes.facets import HEX_FACETS
from tusqh.meshes.volume_mesh import CONNECTING, GRID_CELL, INNER_CELL, SEPARATING

#: Distance of the small quad from the edges of its face, in cells.  On cubic cells the scaled
#: Jacobian of rings is at least 2/3, that of centres 0.9.
_QUAD_INSET = 0.35


@dataclass(frozen=True)
class _Faces:
    """The faces normal to an axis that a marked vertex touches.

    Parameters
    ----------
    lower, upper
        Flat cells on both sides, shape (f,).
    below, above
        Materials of the elements beside the face on both sides, shape (f,).
    rings
        Materials of the four rings, in the order of the corners of the lower cell's face,
        shape (f, 4).
    plain
        Material of both frusta if the face stays plain, -1 if it is refined, shape (f,).
    side
        Direction from the lower to the upper cell into the grid: 1 or -1 for faces on the sides of
        the grid, otherwise 0, shape (f,).
    """

    lower: IntArray
    upper: IntArray
    below: Labels
    above: Labels
    rings: Labels
    plain: Labels
    side: IntArray

    @property
    def owners(self) -> IntArray:
        """Cells of the rings, shape (f,)."""
        return np.where(self.side == 1, self.upper, self.lower)

    def take(self, rows: BoolArray) -> _Faces:
        """Return some faces."""
        return _Faces(*[getattr(self, f.name)[rows] for f in fields(self)])


def emit_spatial(
    decision: SpatialDecision, grid: BackgroundGrid, name: str, *, left_out: int | None = None
) -> Emitted:
    """Return the hexes of all materials including the void, without the outermost layer.

    Parameters
    ----------
    decision
        Materials of cells and sticks.
    grid
        The grid with two layers of void, of shape ``n + 4``.
    name
        The model, for messages.
    left_out
        A material without hexes; None: all have hexes.
    """
    emitted = emit_elements(decision, grid, left_out=left_out).finish(name)
    mesh = emitted.mesh
    kind = name_side_balls(mesh.kind, mesh.grid_cell, decision.field, grid)
    return emitted._replace(mesh=replace(mesh, kind=kind))


def emit_elements(
    decision: SpatialDecision,
    grid: BackgroundGrid,
    *,
    left_out: int | None = None,
    first: int = 0,
) -> Emitter:
    """Return an emitter with the hexes of `emit_spatial`, whose side balls have no name yet.

    Parameters
    ----------
    decision, grid, left_out
        See `emit_spatial`.
    first
        Where the grid begins along x if it is a part of a larger one: an even number of cells from
        its origin.
    """
    labels = decision.labels
    flat = labels.ravel()
    faces = [_find_faces(decision, axis, grid) for axis in range(3)]
    split, frusta = _find_frusta(flat, faces)
    is_split = np.zeros(labels.size, dtype=bool)
    is_split[split] = True
    emitter = Emitter(grid, is_split.reshape(labels.shape), left_out=left_out, first=first)
    is_meshed = np.zeros(labels.shape, dtype=bool)
    is_meshed[1:-1, 1:-1, 1:-1] = True
    is_whole = ~is_split & is_meshed.ravel() & (flat != left_out)
    whole = np.flatnonzero(is_whole)
    emitter.add(emitter.inner(split), split, INNER_CELL, flat[split])
    balls = Balls(emitter, decision.field)
    others = _Others(whole, GRID_CELL, flat[whole])
    _emit_others(emitter, balls, others, emitter.outer(whole), slots_of_cell())
    for face in range(6):
        has = frusta[face] >= 0
        cells, material = split[has], frusta[face, has]
        corners = np.concatenate([emitter.outer(cells), emitter.inner(cells)], axis=1)
        others = _Others(cells, np.where(material == flat[cells], SEPARATING, CONNECTING), material)
        of_frustum = emitter.template.frusta[face]
        slots = slots_of_frustum(face, tuple(of_frustum.tolist()))
        _emit_others(emitter, balls, others, corners[:, of_frustum], slots)
    for axis, found in enumerate(faces):
        _emit_refined(emitter, balls, axis, found)
    return emitter


def _find_frusta(flat: Labels, faces: list[_Faces]) -> tuple[IntArray, Labels]:
    """Return the cells that are split, ascending, and the materials of their frusta.

    The materials have shape (6, number of split cells); -1 on sides without a frustum.
    """
    beside = np.unique(np.concatenate([cells for f in faces for cells in (f.lower, f.upper)]))
    frusta = np.stack([flat[beside]] * 6)
    for axis, found in enumerate(faces):
        frusta[2 * axis + 1, np.searchsorted(beside, found.lower)] = found.plain
        frusta[2 * axis, np.searchsorted(beside, found.upper)] = found.plain
    is_split = (frusta != flat[beside]).any(axis=0)
    return beside[is_split], frusta[:, is_split]


class _Others(NamedTuple):
    """The owners, kinds and materials of elements other than rings."""

    owners: IntArray
    kind: int | IntArray
    material: Labels


def _emit_others(
    emitter: Emitter, balls: Balls, others: _Others, elements: IndexArray, slots: Slots
) -> None:
    """Add elements, split where they touch a ball; only corners in the grid belong to the ball."""
    at_ball = balls.touches(elements)
    if not at_ball.any():
        emitter.add(elements, others.owners, others.kind, others.material)
        return
    kind = np.broadcast_to(others.kind, len(elements))
    plain, touching = np.flatnonzero(~at_ball), np.flatnonzero(at_ball)
    emitter.add(elements[plain], others.owners[plain], kind[plain], others.material[plain])
    found = balls.split_others(elements[touching], slots)
    rows = touching[found.rows]
    owners = others.owners[rows]
    of_ball = (found.vertices >= 0) & balls.inside[emitter.outer(owners)[:, 0]]
    material = np.where(of_ball, balls.material_at(found.vertices), others.material[rows])
    emitter.add(found.elements, owners, np.where(of_ball, CONNECTING, kind[rows]), material)


def _find_faces(decision: SpatialDecision, axis: int, grid: BackgroundGrid) -> _Faces:
    """Return the faces normal to an axis with a marked corner, and their materials."""
    field = decision.field
    numbers, below, above, sticks, has = face_sticks(field, axis)
    first, second = field.steps[axis - 2], field.steps[axis - 1]
    at_ball = np.zeros(len(numbers), dtype=bool)
    for corner in (0, first, second, first + second):
        at_ball |= field.has_ball[numbers + corner]
    # On a side, all elements between the two cells have the material of the cell in the grid.
    inside = field.inside[numbers].astype(np.int64)
    side = inside - field.inside[numbers - field.steps[axis]]
    below, above = np.where(side == 1, above, below), np.where(side == -1, below, above)
    single = np.where(field.sides[axis, numbers] == 1, above, below)
    at_edges = np.where(has, sticks, single[:, None])
    rings = at_edges[:, _ring_order(axis)]
    # Between cells of one material nothing but their own and bridges can be at the edges.
    is_own = (below == above)[:, None] & ~_find_bridged(decision, axis, numbers)
    rings = np.where(is_own, below[:, None], rings)
    is_one = (rings == rings[:, :1]).all(axis=1) & ~at_ball
    is_one &= (rings[:, 0] == below) | (rings[:, 0] == above)
    upper = np.stack(np.unravel_index(numbers, tuple(n + 1 for n in grid.shape)))
    lower = upper - (np.arange(3) == axis)[:, None]
    return _Faces(
        lower=np.ravel_multi_index(tuple(lower), grid.shape),
        upper=np.ravel_multi_index(tuple(upper), grid.shape),
        below=below,
        above=above,
        rings=rings,
        plain=np.where(is_one, rings[:, 0], -1).astype(np.int32),
        side=side,
    )


def _find_bridged(decision: SpatialDecision, axis: int, faces: IntArray) -> BoolArray:
    """Return which rings of faces normal to an axis lie along an edge of a bridge, shape (f, 4)."""
    found = np.zeros((len(faces), 4), dtype=bool)
    if decision.bridged is None:
        return found
    a, b = (axis + 1) % 3, (axis + 2) % 3
    step_a, step_b = decision.field.steps[a], decision.field.steps[b]
    # The edges are in the order of `face_sticks`.
    edges = [(b, faces), (b, faces + step_a), (a, faces), (a, faces + step_b)]
    found = np.stack([decision.bridged[k, e] for k, e in edges], axis=1)
    return np.asarray(found[:, _ring_order(axis)])


def _ring_order(axis: int) -> list[int]:
    """Return the column in `face_sticks` of the edge of every ring of a face."""
    first, second = (axis + 1) % 3, (axis + 2) % 3
    corners = HEX_CORNERS[_upper_face(axis)]
    order = []
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        runs_along_second = a[first] == b[first]
        order.append(int(a[first]) if runs_along_second else 2 + int(a[second]))
    return order


def _upper_face(axis: int) -> IntArray:
    """Return the corners of the upper face of a cell that is normal to an axis."""
    return np.asarray(HEX_FACETS[FACES[3].index((axis, 1))])


def _emit_refined(emitter: Emitter, balls: Balls, axis: int, faces: _Faces) -> None:
    """Add the centres and rings of the refined faces normal to an axis."""
    faces = faces.take(faces.plain < 0)
    local = _upper_face(axis)
    opposite = [_across(int(corner), axis) for corner in local]
    outer = emitter.outer(faces.lower)[:, local]
    below = emitter.inner(faces.lower)[:, local]
    above = emitter.inner(faces.upper)[:, opposite]
    _lay_on_side(emitter, axis, faces, below, above)
    small = _add_small_quads(emitter, axis, faces)
    for quads, owners, material in (
        ([below, small], np.where(faces.side == 1, faces.upper, faces.lower), faces.below),
        ([small, above], np.where(faces.side == -1, faces.lower, faces.upper), faces.above),
    ):
        emitter.add(np.concatenate(quads, axis=1), owners, SEPARATING, material)
    corners = np.stack([outer, below, small, above], axis=2)
    for a in range(4):
        b = (a + 1) % 4
        along = int((HEX_CORNERS[local[a]] != HEX_CORNERS[local[b]]).argmax())
        ends = [ring_end(corners[:, c], HEX_CORNERS[local[c]], along, axis) for c in (a, b)]
        rings = _Rings(faces.owners, faces.below, faces.above, faces.rings[:, a])
        _emit_rings(emitter, balls, ends, rings)


class _Rings(NamedTuple):
    """The owners of rings, and the materials below them, above them and of themselves."""

    owners: IntArray
    below: Labels
    above: Labels
    ring: Labels


def _emit_rings(emitter: Emitter, balls: Balls, ends: list[RingEnd], rings: _Rings) -> None:
    """Add the rings between two ends, split where one of them has a ball."""
    has = [balls.has_ball[end.quad[:, 0]] for end in ends]
    is_even = [balls.is_even(end.quad[:, 0], end.half_edge // 2) for end in ends]
    whole = np.flatnonzero(~has[0] & ~has[1])
    parts = [("ring", whole, np.concatenate([end.quad[whole] for end in ends], axis=1))]
    for first in (0, 1):
        # Split from this end, unless there are balls at both ends and it is the second one.
        rows = np.flatnonzero(has[first] & (is_even[first] | ~has[1 - first]))
        if len(rows) == 0:
            continue
        own, other = (ends[k]._replace(quad=ends[k].quad[rows]) for k in (first, 1 - first))
        for name, found, elements in balls.split(own, other):
            turned = np.roll(elements, 4, axis=1) if first == 1 else elements
            if name in ("first", "second"):
                at = own if name == "first" else other
                material = balls.material_at(at.quad[found, 0])
                emitter.add(turned, rings.owners[rows[found]], CONNECTING, material)
            else:
                parts.append((name, rows[found], turned))
    for name, rows, elements in parts:
        material = getattr(rings, name)[rows]
        is_own = (material == rings.below[rows]) & (material == rings.above[rows])
        kind = np.where(is_own, SEPARATING, CONNECTING)
        emitter.add(elements, rings.owners[rows], kind, material)


def _add_small_quads(emitter: Emitter, axis: int, faces: _Faces) -> IntArray:
    """Return new points in faces, or on the sides of the grid just inside, shape (m, 4)."""
    corners = HEX_CORNERS[_upper_face(axis)]
    lowest = emitter.place_of_cells(faces.lower)
    inset = np.where(faces.side == 0, _QUAD_INSET, SMALL_ON_SIDE[0])[:, None, None]
    points = lowest[:, None] + inset + (1 - 2 * inset) * corners
    points[:, :, axis] = (lowest[:, axis] + 1 + SMALL_ON_SIDE[1] * faces.side)[:, None]
    layers = np.repeat(faces.upper // int(np.prod(emitter.grid.shape[1:])), 4)
    return emitter.add_points(points.reshape(-1, 3), layers).reshape(-1, 4)


def _lay_on_side(
    emitter: Emitter, axis: int, faces: _Faces, below: IntArray, above: IntArray
) -> None:
    """Move the corners of inner cells outside the grid to its side."""
    corners = HEX_CORNERS[_upper_face(axis)]
    for outside, quads in ((faces.side == 1, below), (faces.side == -1, above)):
        lowest = emitter.place_of_cells(faces.lower[outside])
        points = lowest[:, None] + INSET_ON_SIDE + (1 - 2 * INSET_ON_SIDE) * corners
        points[:, :, axis] = (lowest[:, axis] + 1)[:, None]
        emitter.move(quads[outside].ravel(), points.reshape(-1, 3))


def _across(corner: int, axis: int) -> int:
    """Return the corner of the next cell along an axis at the same grid vertex."""
    offset = HEX_CORNERS[corner].copy()
    offset[axis] = 1 - offset[axis]
    return int((offset == HEX_CORNERS).all(axis=1).argmax())
