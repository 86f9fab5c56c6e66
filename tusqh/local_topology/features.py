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

import numpy as np

from tusqh.antialias.cells import CellSets, label_with_bridges
from tusqh.antialias.components import label_holes, label_kept
from tusqh.contacts.one_material_contacts import find_contacts
from tusqh.grid import BoolArray, IntArray
from tusqh.local_topology.changeable import Impossible
from tusqh.local_topology.classes import list_classes
from tusqh.local_topology.done import Done, Row
from tusqh.local_topology.listed_classes import ListedClasses
from tusqh.local_topology.one_change import Accepts, Event, change_class, undo_simple
from tusqh.local_topology.separate import separate
from tusqh.local_topology.wishes import CUT, FILL, OPEN, Wish
from tusqh.local_topology.workspace import Workspace


def _any_cells(kept: BoolArray) -> bool:
    """Return True, because the place says which class is meant."""
    return True


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

        def accepts(kept: BoolArray) -> bool:
            """Return whether the component is separated from all older ones."""
            after = self._components(kept)
            return bool(kept[cell]) and not (outside & (after == after[cell])).any()

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
        kept = undo_simple(self.space, done.kept, kept, cell)
        betti = self.space.cell_set(kept).predicted
        there = done.there | {wish.row}
        n_holes = done.betti.betti_1 - betti.betti_1
        if n_holes > 0:
            there -= self._nearest_holes(done, np.flatnonzero(kept != done.kept), n_holes)
        return self._after(done, wish, kept, there)

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
        accepts: Accepts = _any_cells
        if about.dimension == 0:
            before = self._components(done.kept)
            cell = int(self.space.cells_at(about.birth_place)[0])

            def accepts(kept: BoolArray) -> bool:
                """Return whether the component is joined to an older one."""
                after = self._components(kept)
                others = (after == after[cell]) & (before > 0) & (before != before[cell])
                return bool((self.space.fraction[others] >= about.birth).any())

        event = Event(about.dimension, begins=False, adds=adds)
        return self._around(done, wish, place, event, done.there - {wish.row}, accepts)

    def _around(
        self,
        done: Done,
        wish: Wish,
        place: int,
        event: Event,
        there: frozenset[int],
        accepts: Accepts = _any_cells,
    ) -> Done:
        """Return the cells after one event at a place."""
        kept = change_class(
            self.space,
            done.kept,
            place,
            event,
            before=done.betti,
            is_fixed=self._fixed(done),
            accepts=accepts,
        )
        if kept is None:
            how = "adding" if event.adds else "leaving out"
            raise Impossible(f"{how} cells around it changes other features too")
        return self._after(done, wish, kept, there)

    def _remove_component(self, done: Done, wish: Wish) -> Done:
        """Return the cells without a component and all that is in it."""
        components = self._components(done.kept)
        cell = int(self.space.cells_at(self._rows[wish.row].birth_place)[0])
        is_removed = (components == components[cell]) & (components > 0)
        if not is_removed.any():
            raise Impossible("the base keeps no cell of it")
        self._require_free(is_removed)
        kept = done.kept & ~is_removed
        if not kept.any():
            raise Impossible("it is the only component, and no cell would be left")
        gone = {row for row in done.there if self._lies_in(row, "birth_place", is_removed)}
        return self._after(done, wish, kept, done.there - gone - {wish.row})

    def _fill_region(self, done: Done, wish: Wish) -> Done:
        """Return the cells with all empty cells of a hole in the plane, or of a void, added."""
        cells = self.space.cell_set(done.kept)
        regions = np.pad(label_holes(cells.labels, cells.contacts), 1).ravel()
        cell = int(self.space.cells_at(self._rows[wish.row].death_place)[0])
        if regions[cell] == 0:
            raise Impossible("another change has filled or opened it")
        is_filled = regions == regions[cell]
        self._require_free(is_filled)
        kept = done.kept | is_filled
        gone = {row for row in done.there if self._lies_in(row, "death_place", is_filled)}
        there = done.there - gone - self._joined(done, kept) - {wish.row}
        return self._after(done, wish, kept, there)

    def _joined(self, done: Done, kept: BoolArray) -> set[int]:
        """Return the rows of components that are now joined to an older one."""
        components, oldest, found = self._components(kept), set(), set()
        rows = [row for row in done.there if self._rows[row].dimension == 0]
        for row in sorted(rows, key=lambda r: (-self._rows[r].birth, r)):
            label = components[self.space.cells_at(self._rows[row].birth_place)[0]]
            if label in oldest:
                found.add(row)
            oldest.add(label)
        return found

    def _after(self, done: Done, wish: Wish, kept: BoolArray, there: frozenset[int]) -> Done:
        """Return the cells after a wish, if their Betti numbers are as the classes that are there.

        No later wish changes the cells that this one changed.
        """
        betti, changed = self.space.cell_set(kept).predicted, np.flatnonzero(kept != done.kept)
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

    def _lies_in(self, row: int, event: str, chosen: BoolArray) -> bool:
        """Return whether a class begins or ends among chosen cells."""
        about = self._rows[row]
        # A class that a wish made lies where it begins and ends.
        places = (
            {getattr(about, event)} if about.is_there else {about.birth_place, about.death_place}
        )
        return any(chosen[self.space.cells_at(place)].any() for place in places - {-1})

    def _components(self, kept: BoolArray) -> IntArray:
        """Return the component of every kept cell of the flat grid, from 1; 0 elsewhere."""
        cells = self.space.cell_set(kept)
        return np.pad(label_with_bridges(cells.labels, cells.contacts, cells.bridges), 1).ravel()

    def _require_free(self, chosen: BoolArray) -> None:
        inside = chosen & self.space.is_fixed
        if inside.any():
            raise Impossible("a bridge (`bridges`) ends at its cells")
