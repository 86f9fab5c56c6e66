"""Open, cut and fill single classes of one of several materials.

A class is changed as for one material, with all others as the void
(`tusqh.local_topology.features`).  Cells that it gains are those of the void where possible,
and cells that it loses go to the best other material; where that would change the topology of
others, to the void or to one of the materials around.
Afterwards the Betti numbers of all materials are counted.  The void may change, because it lies in
the holes of the others; another material may only if a whole component is cut or a whole region is
filled, which takes along what lies in it, and this is listed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from tusqh.contacts.label_contacts import find_votes, predict_labels
from tusqh.contacts.material_fractions import MaterialFractions
from tusqh.contacts.surround import surround
from tusqh.errors import ConfigError
from tusqh.grid import BoolArray, IntArray
from tusqh.local_topology.changeable import Impossible
from tusqh.local_topology.done import Done
from tusqh.local_topology.features import Features
from tusqh.local_topology.listed_classes import LocatedClasses
from tusqh.local_topology.one_of_many import OneOfMany
from tusqh.local_topology.relabel import Labels
from tusqh.local_topology.wishes import CUT, FILL, OPEN, Wish


@dataclass(frozen=True)
class MaterialDone:
    """Materials of cells after some wishes.

    Parameters
    ----------
    labels
        Material of every cell, shape n.
    betti
        Betti numbers of one material after the other, the void last, shape (3 m,).
    there
        Rows of the classes that are there.
    steps
        Each wish that changed cells, with the cells it changed, on the flat grid with one layer of
        cells around it.
    """

    labels: Labels
    betti: tuple[int, ...]
    there: frozenset[int]
    steps: tuple[tuple[Wish, IntArray], ...] = ()

    def of(self, material: int) -> tuple[int, ...]:
        """Return the Betti numbers of a material.

        Parameters
        ----------
        material
            Its number.

        Returns
        -------
        betti
            Three numbers.
        """
        return self.betti[3 * material : 3 * material + 3]


class MaterialFeatures(LocatedClasses):
    """The classes of several materials at a base, each of which can be opened, cut or filled.

    Parameters
    ----------
    fractions
        Fractions of all materials.
    thresholds
        Threshold of every material at the base, in multiples of 2**-20, shape (m,).
    names
        The materials whose classes are listed, without the void.
    """

    def __init__(
        self, fractions: MaterialFractions, thresholds: IntArray, names: Sequence[str]
    ) -> None:
        self.fractions, self.thresholds = fractions, thresholds
        self.where = "the base"
        self.base = fractions.label_cells(thresholds)
        # A material without a cell has no class at the base that could be told from noise.
        present = [fractions.names.index(n) for n in names if n in fractions.names]
        self._many = {k: OneOfMany(fractions, k, thresholds) for k in present}
        tables = []
        for k, one in self._many.items():
            table = one.features.classes
            rows = np.arange(len(table), dtype=np.int64)
            tables.append(table.assign(number=k, material=fractions.names[k], row=rows))
        # The classes have the `material`, its `number`, and the `row` among those of the material.
        super().__init__(fractions.grid, pd.concat(tables, ignore_index=True))
        self._first = dict(
            zip(self._many, np.cumsum([0, *map(len, tables)])[:-1].tolist(), strict=True)
        )

        self._last: tuple[Labels, int, Features] | None = None

    def start(self) -> MaterialDone:
        """Return the cells of the base."""
        there = frozenset(np.flatnonzero(self.classes["is_there"]).tolist())
        return MaterialDone(self.base, self._count(self.base), there)

    def rows_of(self, material: str | None) -> IntArray:
        """Return the rows of the classes of a material, in the order in which wishes number them.

        Parameters
        ----------
        material
            Its name.

        Raises
        ------
        ConfigError
            The material does not exist, or the wish does not name one.
        """
        names = [self.fractions.names[k] for k in self._many]
        if material not in names:
            raise ConfigError(
                "a wish for a feature without a material"
                if material is None
                else f"a wish for a feature of {material!r}",
                where="features",
                expected=f"one of the materials {', '.join(names)}",
                remedy="name the material, as `material: ring` or `--fill ring:hole@0.5,1,2`",
            )
        return np.flatnonzero(self.classes["material"] == material).astype(np.int64)

    def position(self, row: int) -> int:
        """Return the place of the number of a class's dimension in `MaterialDone.betti`.

        Parameters
        ----------
        row
            Row of the class.
        """
        return 3 * int(self.classes["number"][row]) + int(self.classes["dimension"][row])

    def describe(self, row: int) -> str:
        """Return a class in words.

        Parameters
        ----------
        row
            Row of the class.
        """
        k, at = int(self.classes["number"][row]), int(self.classes["row"][row])
        return f"{self.fractions.names[k]}, {self._many[k].features.describe(at)}"

    def apply(self, done: MaterialDone, wish: Wish) -> MaterialDone:
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
        k, at = int(self.classes["number"][wish.row]), int(self.classes["row"][wish.row])
        first, one = self._first[k], self._on(k, done.labels)
        own = frozenset(self.rows_of(self.fractions.names[k]).tolist())
        start, there = one.start(), frozenset(r - first for r in done.there & own)
        before = Done(start.kept, start.betti, there, done.steps)  # Cells of earlier wishes stay.
        after = self._take_from_void(one, before, Wish(at, wish.do), done.labels)
        if after is before:
            return done
        changed = after.steps[-1][1]
        kept = one.space.unflatten(after.kept)
        is_whole = wish.do == CUT and self.position(wish.row) % 3 == 0
        is_whole |= wish.do == FILL and self.position(wish.row) % 3 == self.grid.dim - 1
        labels, betti = self._choose(done, k, kept, is_whole=is_whole)
        if betti[3 * k : 3 * k + 3] != tuple(after.betti):
            raise Impossible("it changes other features of the material too")
        others = done.there - own
        if is_whole:
            others -= {r for r in others if self._is_gone(r, done.labels, labels)}
        there = others | {r + first for r in after.there}
        return MaterialDone(labels, betti, there, (*done.steps, (wish, changed)))

    def _take_from_void(self, one: Features, before: Done, wish: Wish, labels: Labels) -> Done:
        """Return the cells of a material after a wish; cells of others are added only if needed."""
        is_other = (labels != self.fractions.void) & ~one.space.unflatten(before.kept)
        if is_other.any() and (wish.do == FILL or (wish.do == OPEN and one.is_below(wish.row))):
            held = np.flatnonzero(np.pad(is_other, 1)).astype(np.int64)
            try:
                after = one.apply(replace(before, steps=(*before.steps, (wish, held))), wish)
            except Impossible:
                pass
            else:
                if len(after.steps) > len(before.steps) + 1:
                    return replace(after, steps=(*before.steps, after.steps[-1]))
        return one.apply(before, wish)

    def _choose(
        self, done: MaterialDone, k: int, kept: BoolArray, *, is_whole: bool
    ) -> tuple[Labels, tuple[int, ...]]:
        """Return the materials of cells, given those of one, and their Betti numbers."""
        tried, others = [], ""
        for labels in self._candidates(done.labels, k, kept):
            betti = self._count(labels)
            others = self.others(done.betti, betti, k)
            tried.append((labels, betti))
            if not others:
                return labels, betti
        is_lost = [
            self.fractions.names[j]
            for j in np.setdiff1d(done.labels, tried[0][0]).tolist()
            if j != self.fractions.void
        ]
        if is_lost:
            raise Impossible(f"no cell of {', '.join(is_lost)} would be left")
        if not is_whole:
            others = self.others(done.betti, tried[0][1], k)
            raise Impossible(f"it changes other materials too: {others}")
        return tried[0]

    def _candidates(self, labels: Labels, k: int, kept: BoolArray) -> Iterator[Labels]:
        """Yield materials of all cells, given those of material k, the best ones first."""
        found = np.where(kept, np.int32(k), labels)
        lost = np.argwhere((labels == k) & ~kept)
        if len(lost) == 0:
            yield found
            return
        around = np.pad(found, 1, constant_values=self.fractions.void)
        steps = np.stack(np.meshgrid(*[[0, 1, 2]] * self.grid.dim), axis=-1)
        near = around[tuple((lost[:, None] + steps.reshape(-1, self.grid.dim)).T)]
        best = self._best_others(lost, k)
        choices = [best, *np.setdiff1d(near, [k])[::-1]]  # The void is the last material.
        for choice in choices:
            labelled = found.copy()
            labelled[tuple(lost.T)] = choice
            yield labelled

    def _best_others(self, cells: IntArray, k: int) -> Labels:
        """Return the best other material at cells of material k, shape (r,)."""
        shape = tuple(2 * n + 1 for n in self.grid.shape)
        places = np.ravel_multi_index(tuple(2 * cells.T + 1), shape).astype(np.int64)
        every = np.arange(len(self.fractions.names), dtype=np.int32)
        multiples = self.fractions.multiples_at(places, np.tile(every, (len(places), 1)))
        scores = multiples / np.maximum(self.thresholds, 1)
        scores[:, k] = -1.0
        best = scores.argmax(axis=1)
        best[scores.max(axis=1) == 0] = self.fractions.void
        return np.asarray(best, dtype=np.int32)

    def others(self, before: Sequence[int], after: Sequence[int], k: int) -> str:
        """Return which other materials have other Betti numbers, in words; empty if none has.

        Parameters
        ----------
        before, after
            Betti numbers of all materials.
        k
            The material that was meant to change.
        """
        found = []
        for j in range(self.fractions.void):
            one, other = (tuple(betti[3 * j : 3 * j + 3]) for betti in (before, after))
            if j != k and one != other:
                found.append(f"{self.fractions.names[j]} {one} to {other}")
        return "; ".join(found)

    def _is_gone(self, row: int, before: Labels, after: Labels) -> bool:
        """Return whether a class ended because its cells have another material now."""
        about = self.classes.iloc[row]
        k, event = about["number"], "birth" if about["dimension"] == 0 else "death"
        space = self._many[k].features.space
        place = int(about[f"{event}_place"])
        if place < 0:
            return False
        index = np.unravel_index(space.cells_at(place), space.shape)
        cells = tuple(np.clip(i - 1, 0, n - 1) for i, n in zip(index, before.shape, strict=True))
        was, now = (labels[cells] == k for labels in (before, after))
        return bool((was & ~now).all() if event == "birth" else (~was & now).all())

    def _on(self, k: int, labels: Labels) -> Features:
        """Return the classes of a material for the present cells; the last answer is kept."""
        if self._last is None or self._last[0] is not labels or self._last[1] != k:
            self._last = labels, k, self._look_at(k, labels)
        return self._last[2]

    def _look_at(self, k: int, labels: Labels) -> Features:
        """Return the classes of a material for the present cells."""
        padded = np.ascontiguousarray(surround(labels, self.fractions.void), dtype=np.int32)
        return self._many[k].on(labels, find_votes(self.fractions, padded, self.thresholds))

    def _count(self, labels: Labels) -> tuple[int, ...]:
        """Return the Betti numbers of all materials, one after the other."""
        every = predict_labels(self.fractions, labels, self.thresholds)
        return tuple(int(n) for betti in every for n in betti)
