"""The materials of cells that differ from those of a base only where the topology needs others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pandas as pd

from tusqh.contacts.material_fractions import MaterialFractions
from tusqh.contacts.mesh import round_thresholds
from tusqh.grid import BoolArray, IntArray
from tusqh.local_topology.feature_cells import change_features
from tusqh.local_topology.material_features import MaterialDone, MaterialFeatures
from tusqh.local_topology.relabel import Labels, relabel_to_base
from tusqh.local_topology.wishes import Wish

#: Columns of the table of changes of several materials, before the coordinates.
CHANGE_COLUMNS = ["from", "to", "cells", "volume", "do", "material", "class", "row"]


class MaterialWish(NamedTuple):
    """What shall be done about a class of a material.

    Parameters
    ----------
    material
        Name of the material.
    row
        Row of the class among those of the material.
    do
        `OPEN`, `CUT` or `FILL`.
    """

    material: str
    row: int
    do: str


@dataclass(frozen=True)
class LocalLabels:
    """The material of every cell, and how it differs from that of the base.

    Parameters
    ----------
    labels, base
        Material of every cell, and at the base, shape n.
    changes
        One row for each connected group of cells that were relabelled from one material to
        another: both materials (`from`, `to`), the number of cells, their volume (model
        units**dim), what was wished for (`do`, `material`, `class`, `row`; empty without a wish
        for a feature), and the centre of the cell nearest to the middle of the group.
    wishes
        What was done about single classes.
    """

    labels: Labels
    base: Labels
    changes: pd.DataFrame
    wishes: tuple[MaterialWish, ...] = ()

    @property
    def n_changes(self) -> int:
        """Number of cells that differ from the base."""
        return int((self.labels != self.base).sum())


def label_locally(
    fractions: MaterialFractions,
    thresholds: Mapping[str, float],
    base: Mapping[str, float],
    wishes: Sequence[MaterialWish] = (),
) -> LocalLabels:
    """Return the materials of cells with the topology of thresholds or wishes, near to a base.

    Parameters
    ----------
    fractions
        Fractions of all materials.
    thresholds
        Threshold of every material at the seed, at which contacts vote.  With wishes it is that of
        the base.
    base
        Threshold of every material at the base.
    wishes
        What shall be done about single classes at the base.

    Raises
    ------
    TopologyError
        A wish cannot be met.

    Examples
    --------
    >>> cells = {"ring": np.array([[1.0, 1, 1], [1, 0, 1], [1, 1, 1]])}
    >>> fractions = MaterialFractions.from_cells(cells)
    >>> found = label_locally(fractions, {}, {}, [MaterialWish("ring", 1, "fill")])
    >>> found.changes[["from", "to", "cells", "do", "class"]].values.tolist()
    [['void', 'ring', 1, 'fill', 'hole']]
    """
    if wishes:
        features = MaterialFeatures(
            fractions,
            round_thresholds(fractions.names, base),
            sorted({wish.material for wish in wishes}, key=fractions.names.index),
        )
        numbered = [Wish(int(features.rows_of(material)[row]), do) for material, row, do in wishes]
        return to_labels(features, change_features(features, numbered), tuple(wishes))
    votes = round_thresholds(fractions.names, thresholds)
    seed = fractions.label_cells(votes)
    goal = fractions.label_cells(round_thresholds(fractions.names, base))
    labels = relabel_to_base(fractions, seed, goal, votes)
    return LocalLabels(labels, goal, _tabulate(fractions, goal, labels, []))


def to_labels(
    features: MaterialFeatures, done: MaterialDone, wishes: tuple[MaterialWish, ...]
) -> LocalLabels:
    """Return the materials of cells after wishes, with the table of what was changed.

    Parameters
    ----------
    features
        The classes at the base.
    done
        The cells after all wishes.
    wishes
        The wishes.
    """
    fractions, base = features.fractions, features.base
    labels = relabel_to_base(fractions, done.labels, base, features.thresholds)
    steps: list[tuple[list[object], BoolArray]] = []
    for wish, changed in done.steps:
        about = features.classes.iloc[wish.row]
        known: list[object] = [wish.do, about["material"], about["class"], int(about["row"])]
        padded = np.zeros([n + 2 for n in base.shape], dtype=bool)
        padded.flat[changed] = True
        steps.append((known, padded[(slice(1, -1),) * base.ndim]))
    table = _tabulate(fractions, base, labels, steps)
    return LocalLabels(labels, base, table, wishes)


def _tabulate(
    fractions: MaterialFractions,
    before: Labels,
    after: Labels,
    steps: list[tuple[list[object], BoolArray]],
) -> pd.DataFrame:
    """Return one row for each group of cells that one wish, or none, has relabelled alike."""
    from scipy import ndimage

    rows, is_left = [], before != after
    none: list[object] = ["", "", "", pd.NA]
    for known, is_changed in [*steps, (none, is_left)]:
        chosen = is_left & is_changed
        is_left &= ~chosen
        pairs = np.unique(np.stack([before[chosen], after[chosen]], axis=1), axis=0)
        for old, new in pairs.tolist():
            alike = chosen & (before == old) & (after == new)
            groups, n = ndimage.label(alike, np.ones((3,) * before.ndim))
            for g, box in enumerate(ndimage.find_objects(groups, n), start=1):
                at = np.argwhere(groups[box] == g) + [along.start for along in box]
                rows.append(
                    [fractions.names[old], fractions.names[new], *_describe(fractions, at, known)]
                )
    table = pd.DataFrame(rows, columns=[*CHANGE_COLUMNS, *"xyz"[: before.ndim]])
    table = table.sort_values("cells", ascending=False, kind="stable", ignore_index=True)
    return table.astype({"cells": np.int64, "row": "Int64"})


def _describe(fractions: MaterialFractions, at: IntArray, known: list[object]) -> list[object]:
    """Return what a row of the table says about cells after the two materials."""
    grid = fractions.grid
    middle = at[((at - at.mean(axis=0)) ** 2).sum(axis=1).argmin()]
    volume = len(at) * grid.cell_size**grid.dim
    return [len(at), volume, *known, *grid.to_points(middle[None] + 0.5)[0].tolist()]
