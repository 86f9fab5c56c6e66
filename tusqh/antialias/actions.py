"""Determine the cells that the two decisions split, and which of their frusta are elements.

The *acting* cells are the kept cells where pinches separate, and the empty cells where they connect
(algorithm 4.3).  Acting cells at a decided vertex or pinch edge are split.  A frustum is
*decided* if its face touches a decided vertex, or contains a decided pinch edge, and the cell
across that face does not act: separating removes the frustum, connecting adds it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tusqh.antialias.clusters import CONNECT, SEPARATE
from tusqh.antialias.pinches import find_pinch_edges, neighbourhood_codes, template_tables
from tusqh.contacts.templates import TEMPLATES
from tusqh.grid.arrays import BoolArray
from tusqh.grid.neighbourhoods import across_faces, at_corners, neighbours_along, window
from tusqh.grid.numbering import FACES, HEX_CORNERS


@dataclass(frozen=True)
class Action:
    """The vertices and edges at which one of the two decisions acts.

    Parameters
    ----------
    decision
        `SEPARATE` or `CONNECT`.
    kept
        Kept cells, shape n.
    at_vertex
        Vertices with that decision at which it changes the mesh, shape ``n + 1``.
    at_edge
        In 3D, the pinch edges with that decision, along each axis.
    """

    decision: int
    kept: BoolArray
    at_vertex: BoolArray
    at_edge: list[BoolArray]

    @property
    def acting(self) -> BoolArray:
        """The acting cells, shape n."""
        return self.kept if self.decision == SEPARATE else ~self.kept

    @cached_property
    def split(self) -> BoolArray:
        """The acting cells that are split, shape n."""
        return np.asarray(self.acting & np.logical_or.reduce([*self.touched, *self.crossed]))

    @cached_property
    def touched(self) -> list[BoolArray]:
        """For every face number, the cells whose face touches a decided vertex, shape n each."""
        corners = at_corners(self.at_vertex)
        facets = TEMPLATES[self.kept.ndim].facets
        return [np.asarray(np.logical_or.reduce([corners[c] for c in f])) for f in facets]

    @cached_property
    def crossed(self) -> list[BoolArray]:
        """For every face number, the cells whose face has a decided pinch edge, shape n each."""
        found = []
        for face_axis, end in FACES[self.kept.ndim]:
            crossed = np.zeros(self.kept.shape, dtype=bool)
            for along, edges in enumerate(self.at_edge):
                for corner in HEX_CORNERS[HEX_CORNERS[:, face_axis] == end]:
                    if along != face_axis and corner[along] == 0:
                        crossed |= window(edges, corner, self.kept.shape)
            found.append(crossed)
        return found

    @cached_property
    def frusta(self) -> list[BoolArray]:
        """For every face number, the cells whose frustum there is an element, shape n each."""
        separates = self.decision == SEPARATE
        emitted = []
        for is_kept, touched, crossed in zip(
            across_faces(self.kept), self.touched, self.crossed, strict=True
        ):
            is_other_side = ~is_kept if separates else is_kept
            is_decided = is_other_side & (touched | crossed)
            if not separates:
                emitted.append(self.split & is_decided)
            elif self.kept.ndim == 2:
                emitted.append(self.split & ~is_decided)
            else:  # The 2-6 template replaces the frusta between two split cells.
                emitted.append(self.split & ~is_decided & ~(is_kept & touched))
        return emitted


def find_actions(
    kept: BoolArray, at_vertex: NDArray[np.int8], is_freed: BoolArray
) -> tuple[Action, Action]:
    """Return the actions of the decisions to separate and to connect.

    Parameters
    ----------
    kept
        Kept cells, shape n.
    at_vertex
        `SEPARATE`, `NONE` or `CONNECT` for every grid vertex, shape ``n + 1``.
    is_freed
        Vertices at which the templates act regardless of the neighbourhood, shape ``n + 1``.

    Returns
    -------
    separate, connect
        Where each of the two decisions acts.
    """
    separate, connect = (
        Action(
            decision=decision,
            kept=kept,
            at_vertex=(at_vertex == decision) & acts,
            at_edge=_decided_edges(kept, at_vertex == decision),
        )
        for decision, acts in zip(
            (SEPARATE, CONNECT), _where_templates_act(kept, is_freed), strict=True
        )
    )
    return separate, connect


def _where_templates_act(kept: BoolArray, is_freed: BoolArray) -> tuple[BoolArray, BoolArray]:
    """Return the vertices at which separating, and those at which connecting, changes the mesh."""
    if kept.ndim == 2:
        everywhere = np.ones(is_freed.shape, dtype=bool)
        return everywhere, everywhere
    codes = neighbourhood_codes(kept)
    separates, connects = template_tables()
    return separates[codes] | is_freed, connects[codes] | is_freed


def _decided_edges(kept: BoolArray, is_decided: BoolArray) -> list[BoolArray]:
    """Return the pinch edges along each axis of a 3D grid whose ends are both decided."""
    found = []
    for axis in range(3) if kept.ndim == 3 else ():
        lower, upper = neighbours_along(is_decided, axis)
        found.append(find_pinch_edges(kept, axis) & lower & upper)
    return found
