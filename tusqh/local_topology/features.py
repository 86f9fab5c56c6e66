"""Open, cut and fill single classes of the persistence diagram.

*Open* keeps a class, or makes one that the base lacks; *cut* ends a class by leaving out cells, and
*fill* by adding some.  A component is cut by leaving all of it out, a hole in the plane and a void
are filled by adding all cells in them; all others are changed along a path or membrane, see
`tusqh.local_topology.one_change`.  A component that is joined to others at several places is
separated at all of them together, see `tusqh.local_topology.separate`.
"""

from __future__ import annotations

from copy import copy
from dataclasses import replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from tusqh.antialias.cells import CellSets, label_with_bridges
from tusqh.antialias.components import label_kept
from tusqh.contacts.one_material_contacts import find_contacts
from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.local_topology.changeable import Impossible
from tusqh.local_topology.classes import list_classes
from tusqh.local_topology.done import Done, Row
from tusqh.local_topology.listed_classes import ListedClasses
from tusqh.local_topology.one_change import Accepts, Event, change_class, undo_simple
from tusqh.local_topology.separate import separate
from tusqh.local_topology.wishes import CUT, FILL, OPEN, Wish
from tusqh.local_topology.workspace import NO_NAMES, Split, Workspace
from tusqh.topology.betti_numbers import BettiNumbers


class _Components(NamedTuple):
    """The components of kept cells.

    Parameters
    ----------
    kept
        The cells.
    names
        Component of every cell from 1, 0 for empty cells, flat.
    oldest
        Largest fraction among the cells of every component; 0 for the empty cells.
    """

    kept: BoolArray
    names: IntArray
    oldest: FloatArray


class Features(ListedClasses):
    """The classes of the diagram at a base, each of which can be opened, cut or filled.

    Parameters
    ----------
    cell_sets
        The cells of every threshold.
    base
        Threshold of the base in (0, 1].
    """

    def __init__(self, cell_sets: CellSets, base: float) -> None:
        self._cell_sets = cell_sets
        self.space = Workspace(cell_sets.at(base))
        table = list_classes(cell_sets.fractions, cell_sets.topology)
        is_there = (table["birth"] >= base) & (table["death"] < base)
        classes = table.assign(base=base, is_there=is_there)
        super().__init__(cell_sets.fractions.grid, classes, base)
        columns = (self.classes[name].tolist() for name in Row._fields)
        self._rows = [Row(*values) for values in zip(*columns, strict=True)]
        self._last: _Components | None = None

    def on(self, kept: BoolArray, votes: BoolArray) -> Features:
        """Return the same classes for other cells, whose contacts have other votes.

        Parameters
        ----------
        kept
            Kept cells, shape n.
        votes
            Which places of the doubled grid vote to connect, shape ``2 n + 1``.
        """
        other, start = copy(self), self.space.start
        contacts = find_contacts(kept, votes)
        other.space = Workspace(replace(start, kept=kept, contacts=contacts), votes)
        other._last = None
        return other

    def start(self) -> Done:
        """Return the cells of the base."""
        start, rows = self.space.start, np.flatnonzero(self.classes["is_there"]).tolist()
        return Done(self.space.flatten(start.kept), start.predicted, frozenset(rows))

    def apply(self, done: Done, wish: Wish) -> Done:
        """Return the cells after one more wish.

        Parameters
        ----------
        done
            The cells so far.
        wish
            The wish; it changes nothing if the class is as wished.

        Raises
        ------
        Impossible
            The wish cannot be met.
        """
        about = self._rows[wish.row]
        if wish.do == OPEN:
            if about.is_there and wish.row not in done.there:
                raise Impossible("an earlier change ended it")
            return done if wish.row in done.there else self._open(done, wish)
        if wish.row not in done.there:
            return done
        if wish.do == CUT and about.dimension == 0:
            return self._remove_component(done, wish)
        if wish.do == FILL and about.dimension == self.grid.dim - 1:
            return self._fill_region(done, wish)
        return self._end(done, wish)

    def _open(self, done: Done, wish: Wish) -> Done:
        """Return the cells with a class that the base lacks."""
        about = self._rows[wish.row]
        adds = about.birth < self.base
        place = about.birth_place if adds else about.death_place
        event = Event(about.dimension, begins=True, adds=adds)
        there = done.there | {wish.row}
        if adds or about.dimension > 0:
            return self._around(done, wish, place, event, there)
        inside, outside = self._sides(wish.row, done.kept)
        cell = int(self.space.cells_at(about.birth_place)[0])
        known = self._components(done.kept).names

        def accepts(kept: BoolArray, split: Split) -> bool:
            """Return whether the component is separated from all older ones."""
            own = known == known[cell]
            if split.names[0] == known[cell]:
                is_side = np.zeros(len(kept), dtype=bool)
                is_side[split.cells] = True
                own &= is_side == is_side[cell]
            return bool(kept[cell]) and not (outside & kept & own).any()

        try:
            return self._around(done, wish, place, event, there, accepts)
        except Impossible:
            return self._separate(done, wish, inside, outside)

    def _sides(self, row: int, kept: BoolArray) -> tuple[BoolArray, BoolArray]:
        """Return the kept cells of a component before it ended, and those of the older ones."""
        about = self._rows[row]
        above = self._cell_sets.at(float(np.nextafter(about.death, 1.0)))
        labels = np.pad(label_kept(above.labels, above.contacts), 1).ravel()
        oldest = np.zeros(int(labels.max(initial=0)) + 1)
        np.maximum.at(oldest, labels, self.space.fraction)
        own = labels[self.space.cells_at(about.birth_place)[0]]
        is_older = (oldest >= about.birth) & (np.arange(len(oldest)) > 0)
        is_older[own] = False
        return kept & (labels == own) & (labels > 0), kept & is_older[labels]

    def _separate(self, done: Done, wish: Wish, inside: BoolArray, outside: BoolArray) -> Done:
        """Return the cells with a component separated from older ones at all of its joints."""
        kept = separate(self.space, done.kept, inside, outside, self._fixed(done))
        if kept is None:
            raise Impossible("no cells between it and the others can be left out")
        cell = int(self.space.cells_at(self._rows[wish.row].birth_place)[0])
        kept = undo_simple(self.space, kept, np.flatnonzero(kept != done.kept), cell)
        betti = self.space.cell_set(kept).predicted
        there = done.there | {wish.row}
        n_holes = done.betti.betti_1 - betti.betti_1
        if n_holes > 0:
            there -= self._nearest_holes(done, np.flatnonzero(kept != done.kept), n_holes)
        return self._after(done, wish, kept, there, betti)

    def _nearest_holes(self, done: Done, cells: IntArray, n: int) -> frozenset[int]:
        """Return the holes that begin nearest to cells, which are the loops through its joints."""
        at = np.stack(np.unravel_index(cells, self.space.shape), axis=1)
        distance = {}
        for row in done.there:
            if self._rows[row].dimension == 1:
                begins = self.space.cells_at(self._rows[row].birth_place)
                index = np.stack(np.unravel_index(begins, self.space.shape), axis=1)
                distance[row] = int(((at[:, None] - index) ** 2).sum(axis=-1).min())
        return frozenset(sorted(distance, key=lambda row: (distance[row], row))[:n])

    def _end(self, done: Done, wish: Wish) -> Done:
        """Return the cells after a class is ended along a path or membrane."""
        about = self._rows[wish.row]
        adds = wish.do == FILL
        place = about.death_place if adds else about.birth_place
        if place < 0:
            raise Impossible("it is the oldest component, to which others are joined")
        accepts: Accepts | None = None
        if about.dimension == 0:
            components = self._components(done.kept)
            own = components.names[self.space.cells_at(about.birth_place)[0]]

            def accepts(kept: BoolArray, split: Split) -> bool:
                """Return whether the component is joined to an older one."""
                first, second = split.names
                other = second if first == own else first
                return own in split.names and bool(components.oldest[other] >= about.birth)

        event = Event(about.dimension, begins=False, adds=adds)
        return self._around(done, wish, place, event, done.there - {wish.row}, accepts)

    def _around(
        self,
        done: Done,
        wish: Wish,
        place: int,
        event: Event,
        there: frozenset[int],
        accepts: Accepts | None = None,
    ) -> Done:
        """Return the cells after one event at a place."""
        kept = change_class(
            self.space,
            done.kept,
            place,
            event,
            is_fixed=self._fixed(done),
            accepts=accepts,
            known=self._components(done.kept).names if accepts else NO_NAMES,
        )
        if kept is None:
            how = "adding" if event.adds else "leaving out"
            raise Impossible(f"{how} cells around it changes other features too")
        betti = BettiNumbers(*np.add(done.betti, event.effect).tolist())
        return self._after(done, wish, kept, there, betti)

    def _remove_component(self, done: Done, wish: Wish) -> Done:
        """Return the cells without a component and all that is in it."""
        cell = self.space.cells_at(self._rows[wish.row].birth_place)[:1]
        if not done.kept[cell].all():
            raise Impossible("the base keeps no cell of it")
        if done.betti.betti_0 == 1:
            raise Impossible("it is the only component, and no cell would be left")
        removed, _ = self.space.flood(done.kept, cell, follows_kept=True)
        self._require_free(removed)
        kept = done.kept.copy()
        kept[removed] = False
        betti = np.subtract(done.betti, self.space.betti_of(removed, are_kept=True))
        there = done.there - self._lie_in(done.there, "birth", removed) - {wish.row}
        return self._after(done, wish, kept, there, self._unless_bridged(kept, betti))

    def _fill_region(self, done: Done, wish: Wish) -> Done:
        """Return the cells with all empty cells of a hole in the plane, or of a void, added."""
        cell = self.space.cells_at(self._rows[wish.row].death_place)[:1]
        filled, is_outside = self.space.flood(done.kept, cell, follows_kept=False)
        if is_outside or done.kept[cell].any():
            raise Impossible("another change has filled or opened it")
        self._require_free(filled)
        kept = done.kept.copy()
        kept[filled] = True
        # By duality, the region takes one class along for each class of its own.
        region = self.space.betti_of(filled, are_kept=False)
        dual = (region[2], region[1], 1) if self.grid.dim == 3 else (region[1], 1, 0)
        betti = np.subtract(done.betti, dual)
        there = done.there - self._lie_in(done.there, "death", filled) - {wish.row}
        there -= self._joined(done, kept, filled)
        return self._after(done, wish, kept, there, self._unless_bridged(kept, betti))

    def _unless_bridged(self, kept: BoolArray, betti: IntArray) -> BettiNumbers:
        """Return Betti numbers, counted again if there are bridges, which cells do not show."""
        if self.space.start.bridges:
            return self.space.cell_set(kept).predicted
        return BettiNumbers(*betti.tolist())

    def _joined(self, done: Done, kept: BoolArray, filled: IntArray) -> frozenset[int]:
        """Return the rows of components that filled cells join to an older one."""
        names = self._components(done.kept).names
        reached, _ = self.space.flood(kept, filled, follows_kept=True, known=names)
        joined = set(names[reached].tolist()) - {0}
        rows = [row for row in done.there if self._rows[row].dimension == 0]
        cells = {row: self.space.cells_at(self._rows[row].birth_place)[0] for row in rows}
        rows = [row for row in rows if names[cells[row]] in joined]
        return frozenset(sorted(rows, key=lambda r: (-self._rows[r].birth, r))[1:])

    def _after(
        self,
        done: Done,
        wish: Wish,
        kept: BoolArray,
        there: frozenset[int],
        betti: BettiNumbers,
    ) -> Done:
        """Return the cells after a wish, if their Betti numbers are as the classes that are there.

        No later wish changes the cells that this one changed.
        """
        changed = np.flatnonzero(kept != done.kept)
        expected = np.array(done.betti)
        for rows, sign in ((there - done.there, 1), (done.there - there, -1)):
            for row in rows:
                expected[self._rows[row].dimension] += sign
        if tuple(expected) != tuple(betti):
            raise Impossible("it changes other features too")
        return Done(kept, betti, there, (*done.steps, (wish, changed)))

    def _fixed(self, done: Done) -> BoolArray:
        """Return the cells that must stay, among them those that earlier wishes changed."""
        is_fixed = self.space.is_fixed.copy()
        for _, changed in done.steps:
            is_fixed[changed] = True
        return is_fixed

    def _lie_in(self, rows: frozenset[int], event: str, chosen: IntArray) -> frozenset[int]:
        """Return the rows of classes that begin or end among chosen cells."""
        is_chosen = np.zeros(len(self.space.is_fixed), dtype=bool)
        is_chosen[chosen] = True
        listed = np.array(sorted(rows), dtype=np.int64)
        is_in = is_chosen[self._cells_at[event][listed]].any(axis=1)
        # A class that a wish made lies where it begins and ends.
        is_made = ~self.classes["is_there"].to_numpy()[listed]
        for other in self._cells_at.values():
            is_in |= is_made & is_chosen[other[listed]].any(axis=1)
        return frozenset(listed[is_in].tolist())

    @cached_property
    def _cells_at(self) -> dict[str, IntArray]:
        """The flat cells around the places where classes begin and end, by event, shape (r, 8)."""
        found = {}
        for event in ("birth", "death"):
            # The first cell of the flat grid lies outside, and is never changed.
            cells = np.zeros((len(self._rows), 8), dtype=np.int64)
            for row, place in enumerate(self.classes[f"{event}_place"].tolist()):
                if place >= 0:
                    around = self.space.cells_at(place)
                    cells[row, : len(around)] = around
            found[event] = cells
        return found

    def _components(self, kept: BoolArray) -> _Components:
        """Return the components of the kept cells of the flat grid; the last answer is kept."""
        if self._last is None or self._last.kept is not kept:
            cells = self.space.cell_set(kept)
            names = label_with_bridges(cells.labels, cells.contacts, cells.bridges)
            flat = np.pad(names, 1).ravel()
            oldest = np.zeros(int(flat.max(initial=0)) + 1)
            np.maximum.at(oldest, flat, self.space.fraction)
            oldest[0] = 0.0
            self._last = _Components(kept, flat, oldest)
        return self._last

    def _require_free(self, cells: IntArray) -> None:
        if self.space.is_fixed[cells].any():
            raise Impossible("a bridge (`bridges`) ends at its cells")
