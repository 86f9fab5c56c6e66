"""The cells of a base after single classes were opened, cut or filled."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from tusqh.antialias.cells import CellSets
from tusqh.errors import TopologyError
from tusqh.local_topology.changeable import Changeable, Impossible, S
from tusqh.local_topology.changes import ADDED, CHANGE_COLUMNS, LEFT_OUT, describe_group
from tusqh.local_topology.done import Done
from tusqh.local_topology.features import Features
from tusqh.local_topology.move import LocalCells, approach
from tusqh.local_topology.wishes import OPEN, Wish


class FeatureCellSets(CellSets):
    """The cell set of every threshold as a base, with some classes opened, cut or filled.

    Parameters
    ----------
    cell_sets
        The cells of every threshold.
    wishes
        What shall be done, in this order.
    """

    def __init__(self, cell_sets: CellSets, wishes: Sequence[Wish]) -> None:
        super().__init__(cell_sets.fractions, cell_sets.policy, topology=cell_sets.topology)
        self._wishes = wishes

    def at(self, threshold: float) -> LocalCells:
        """Return the cells of a threshold after all wishes.

        Parameters
        ----------
        threshold
            Volume-fraction threshold of the base in (0, 1], dimensionless.

        Raises
        ------
        TopologyError
            A wish cannot be met.
        """
        plain = CellSets(self.fractions, self.policy, topology=self.topology)
        features = Features(plain, threshold)
        return to_cells(features, change_features(features, self._wishes), self._wishes)


def repeat_choice(cell_sets: CellSets, base: float | None, wishes: Sequence[Wish]) -> CellSets:
    """Return the cell sets from which a choice was made.

    Parameters
    ----------
    cell_sets
        The cells of every threshold.
    base
        The threshold that was approached, see `tusqh.local_topology.move.approach`.
    wishes
        The classes that were opened, cut or filled at the base.
    """
    return FeatureCellSets(cell_sets, wishes) if wishes else approach(cell_sets, base)


def change_features(features: Changeable[S], wishes: Sequence[Wish]) -> S:
    """Return the cells after all wishes; one that is impossible at first is tried again later.

    Parameters
    ----------
    features
        The classes at the base.
    wishes
        What shall be done, in this order.

    Raises
    ------
    TopologyError
        A wish cannot be met, or contradicts another one.
    """
    done, waiting = features.start(), list(wishes)
    while waiting:
        left, reasons = [], []
        for wish in waiting:
            try:
                done = features.apply(done, wish)
            except Impossible as reason:
                left.append(wish)
                reasons.append(str(reason))
        if len(left) == len(waiting):
            is_there = bool(features.classes["is_there"][left[0].row])
            if left[0].do == OPEN and is_there:
                raise _contradiction(features, left[0], wishes)
            raise _cannot(features, left[0], reasons[0], done)
        waiting = left
    for wish in wishes:
        if wish.do == OPEN and wish.row not in done.there:
            raise _contradiction(features, wish, wishes)
    return done


def to_cells(features: Features, done: Done, wishes: Sequence[Wish]) -> LocalCells:
    """Return the changed cells with their contacts and the table of what was changed.

    Parameters
    ----------
    features
        The classes at the base.
    done
        The cells after all wishes.
    wishes
        The wishes.

    Raises
    ------
    TopologyError
        The cells have other Betti numbers than the changes add up to, which is a fault of Tusqh.
    """
    space, base = features.space, features.space.start
    cells = space.cell_set(done.kept)
    if cells.predicted != done.betti:
        raise TopologyError(
            f"Betti numbers {cells.predicted} after changes of features",
            where=f"the cells of {features.where}",
            expected=f"the Betti numbers {done.betti} that the changes add up to",
            remedy="this is a fault of tusqh: please report it with fractions.npz",
        )
    return LocalCells(
        threshold=base.threshold,
        kept=cells.kept,
        contacts=cells.contacts,
        fractions=cells.fractions,
        bridges=base.bridges,
        bridge_table=base.bridge_table,
        features=base.features,
        base=base.threshold,
        in_base=base.kept,
        changes=_tabulate(features, done),
        n_held=0,
        n_other_contacts=0,
        wishes=tuple(wishes),
    )


def _tabulate(features: Features, done: Done) -> pd.DataFrame:
    """Return one row per feature that was changed."""
    space, rows = features.space, []
    for wish, changed in done.steps:
        is_changed = np.zeros(len(done.kept), dtype=bool)
        is_changed[changed] = True
        at = np.argwhere(space.unflatten(is_changed))
        change = ADDED if done.kept[changed[0]] else LEFT_OUT
        about = features.classes.iloc[wish.row]
        group = describe_group(at, space.start.fractions)
        rows.append([change, *group[:4], wish.do, about["class"], wish.row, *group[4:]])
    table = pd.DataFrame(rows, columns=[*CHANGE_COLUMNS, *"xyz"[: features.grid.dim]])
    return table.astype({"cells": np.int64, "row": "Int64"})


def _cannot(features: Changeable[S], wish: Wish, reason: str, done: S) -> TopologyError:
    """Return the error for a wish that cannot be met."""
    near = features.nearest(wish.row, done)
    return TopologyError(
        f"cannot {wish.do} {features.describe(wish.row)}",
        where=f"the cells of {features.where}",
        expected=f"a change of cells that does only this; {reason}",
        remedy="wish for another way, or also for the classes near it:\n    "
        + "\n    ".join(map(features.describe, near)),
    )


def _contradiction(features: Changeable[S], wish: Wish, wishes: Sequence[Wish]) -> TopologyError:
    """Return the error for a class that shall stay and ends by another wish."""
    others = [w for w in wishes if w.do != OPEN]
    return TopologyError(
        f"{features.describe(wish.row)} shall stay, but it ends with another wish",
        where="features",
        expected="wishes that do not contradict each other",
        remedy="leave out one of these:\n    "
        + "\n    ".join(f"{w.do} {features.describe(w.row)}" for w in [wish, *others]),
    )
