"""Change one class of the topology by the fewest cells around the place where it begins or ends.

Simple cells around the place are changed first, which changes no topology, until the cell at the
place is the only one that still separates two parts, closes a loop or leaves a membrane open.  This
cell is changed too: one event, whose effect is measured.  Then all changes that are simple are
undone, the farthest first, and what is left is a thin path or membrane through the place.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from tusqh.grid import BoolArray, IntArray
from tusqh.local_topology.workspace import NO_NAMES, Split, Workspace

#: Largest number of cells around the place that are tried as the event at each distance.
_TRIALS = 6

#: A class that ends is the one at its place if a cell this near to the place changes.
_NEAR = 2


class Event(NamedTuple):
    """What one change shall do.

    Parameters
    ----------
    dimension
        Dimension of the class: 0, 1 or 2.
    begins
        Whether a class begins; otherwise one ends.
    adds
        Whether cells are added; otherwise they are removed.
    """

    dimension: int
    begins: bool
    adds: bool

    def pieces(self, dim: int) -> tuple[int, int]:
        """Return the pieces of the neighbours of the last cell, present ones and absent ones.

        Parameters
        ----------
        dim
            Dimension of the grid.

        Returns
        -------
        present, absent
            The two numbers.

        Examples
        --------
        A tunnel is filled by a membrane, whose last cell has two absent pieces; a loop is cut at a
        cell with two present ones:

        >>> [Event(1, begins=False, adds=adds).pieces(3) for adds in (True, False)]
        [(1, 2), (2, 1)]
        """
        # As if the cell were added: a class of this dimension begins, or one of it ends.
        is_born = self.begins == self.adds
        if is_born and self.dimension == 0:
            return 0, 1
        if not is_born and self.dimension == dim - 1:
            return 1, 0
        if dim == 2:
            return 2, 2
        return (2, 1) if self.is_among_kept else (1, 2)

    @property
    def is_among_kept(self) -> bool:
        """Whether the last cell stands between two pieces of kept cells, not of empty ones."""
        return self.dimension == (1 if self.begins == self.adds else 0)

    @property
    def effect(self) -> tuple[int, int, int]:
        """The change of the Betti numbers."""
        sign = 1 if self.begins else -1
        return tuple(sign * (k == self.dimension) for k in range(3))  # type: ignore[return-value]


#: Decides whether cells in which two pieces are not joined have changed the class that was meant.
Accepts = Callable[[BoolArray, Split], bool]


def change_class(
    space: Workspace,
    kept: BoolArray,
    place: int,
    event: Event,
    *,
    is_fixed: BoolArray,
    accepts: Accepts | None = None,
    known: IntArray = NO_NAMES,
) -> BoolArray | None:
    """Return cells in which one event has happened at a place, None if it cannot.

    Parameters
    ----------
    space
        Votes of the contacts.
    kept
        Kept cells of the flat grid.
    place
        Flat index into the doubled grid of the place where the class begins or ends.
    event
        What shall happen.
    is_fixed
        Cells of the flat grid that do not change.
    accepts
        Decides whether the class that was meant has changed, where it is a component; None: the
        place says so.
    known
        Names of the components of `kept` for this decision, see `Workspace.split`.
    """
    around = space.cells_at(place)
    center = _center(space, kept, around, event, is_fixed)
    is_near = np.zeros(len(kept), dtype=bool)
    is_near[space.cells_near(center, _NEAR)] = True
    for radius in _radii(max(space.shape)):
        cells = space.cells_near(center, radius)
        cells = cells[(kept[cells] != event.adds) & ~is_fixed[cells]]
        for last, grown in _grow(space, kept, cells, center, event):
            split = _split(space, grown, last, event, known)
            grown[last] = event.adds
            if split.is_joined == (event.dimension == 1) and (
                accepts is None or accepts(grown, split)
            ):
                found = _prune(space, kept, grown, last, np.append(cells, last))
                if event.begins or (found != kept)[is_near].any():
                    return found
            grown[last] = not event.adds
    return None


def _split(space: Workspace, grown: BoolArray, last: int, event: Event, known: IntArray) -> Split:
    """Return whether what the last cell stands between is joined elsewhere, which tells its effect.

    A cell that joins two pieces closes a loop if they are joined already, and otherwise makes one
    component of two; likewise for the empty pieces that it separates.  The classes of the highest
    dimension and single cells need no such decision.
    """
    present, absent = space.find_pieces(grown, last)
    pieces = present if event.is_among_kept else absent
    if len(pieces) < 2:
        return Split(event.dimension == 1, NO_NAMES, (0, 0))
    return space.split(grown, last, pieces, follows_kept=event.is_among_kept, known=known)


def _center(
    space: Workspace, kept: BoolArray, around: IntArray, event: Event, is_fixed: BoolArray
) -> int:
    """Return the cell at a place: the one that can change and whose fraction is the nearest."""
    value = space.fraction[around] * (1 if event.adds else -1)
    cannot = (kept[around] == event.adds) | is_fixed[around]
    return int(around[np.lexsort((around, -value, cannot))[0]])


def _radii(largest: int) -> Iterator[int]:
    """Yield distances around the place, up to the whole grid."""
    radius = 1
    while radius < largest:
        yield radius
        radius = max(radius + 1, int(radius * 1.5))
    yield largest


def _grow(
    space: Workspace, kept: BoolArray, cells: IntArray, center: int, event: Event
) -> Iterator[tuple[int, BoolArray]]:
    """Yield cells that make the event when they change, with all simple changes before them."""
    value = space.fraction[cells] * (1 if event.adds else -1)
    distance = space.squared_distance(cells, center)
    cells = cells[np.lexsort((cells, -distance, -value))]
    pieces = event.pieces(space.dim)
    for is_free in (False, True):
        grown = kept.copy()
        space.change_simple(grown, cells if is_free else cells[cells != center])
        left = cells[grown[cells] != event.adds]
        left = left[np.argsort(space.squared_distance(left, center), kind="stable")]
        for last in space.find_events(grown, left, pieces, _TRIALS).tolist():
            yield last, grown


def _prune(
    space: Workspace, kept: BoolArray, grown: BoolArray, last: int, tried: IntArray
) -> BoolArray:
    """Return the cells after undoing all changes that are simple, that of the last cell last."""
    cells = tried[grown[tried] != kept[tried]]
    found = undo_simple(space, grown, cells[cells != last], last)
    return undo_simple(space, found, cells[found[cells] != kept[cells]], last)


def undo_simple(space: Workspace, changed: BoolArray, cells: IntArray, center: int) -> BoolArray:
    """Return changed cells after undoing all changes that are simple, the farthest ones first.

    Parameters
    ----------
    space
        Votes of the contacts.
    changed
        Cells of the flat grid after the changes.
    cells
        The flat cells that were changed, shape (r,).
    center
        The flat cell from which distances count.
    """
    found, cells = changed.copy(), np.unique(cells)
    distance = space.squared_distance(cells, center)
    space.change_simple(found, cells[np.argsort(-distance, kind="stable")])
    return found
