"""Choose the thresholds of several materials so that each has the Betti numbers wished for.

The materials with targets are taken in the user's order.  For each, the Betti numbers of its score
field (`tusqh.contacts.score_field`) at every threshold give intervals with the target, the widest
first, and the first one that is confirmed by the prediction of the mesh is taken.  As the choice
changes the scores of the others, this is repeated until all wishes hold.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from tusqh.contacts import MaterialFractions, MaterialMesh, mesh_materials
from tusqh.contacts.score_field import score_field
from tusqh.errors import TopologyError
from tusqh.settings.goal import Target
from tusqh.settings.materials import Material
from tusqh.threshold.goals import distances, matches
from tusqh.topology.betti_numbers import BettiNumbers
from tusqh.topology.topology import Topology

#: Number of times that all wishes are taken in turn.
_ROUNDS = 4

#: Number of intervals of one wish for which a mesh is predicted, and of those that are listed.
_TRIALS, _LISTED = 12, 8

#: Shares of the score, between which thresholds are chosen: 1 / 16 to 16 times the others'.
_LOWEST, _HIGHEST = 1 / 17, 16 / 17

_BETTI = ["betti_0", "betti_1", "betti_2"]


@dataclass(frozen=True)
class Fulfilled:
    """A mesh that fulfils every wish.

    Parameters
    ----------
    mesh
        The mesh.
    thresholds
        Threshold of every material by name, the void included; only their ratios matter.
    """

    mesh: MaterialMesh
    thresholds: dict[str, float]


def fulfil(fractions: MaterialFractions, wishes: Sequence[Material], *, name: str) -> Fulfilled:
    """Return the mesh of materials with the thresholds and Betti numbers wished for.

    Parameters
    ----------
    fractions
        Fractions of all materials.
    wishes
        Materials with a threshold or a target; the others have the threshold 1.
    name
        Name of the mesh.

    Raises
    ------
    TopologyError
        Not all wishes can be fulfilled; the message names the first that fails, and what can be
        reached for it while the others stay as they are.
    """
    thresholds = dict.fromkeys(fractions.names, 1.0)
    thresholds |= {w.name: w.threshold for w in wishes if w.threshold is not None}
    targets = {w.name: w.target for w in wishes if w.target is not None}
    found = _predict(fractions, thresholds, name)
    for _ in range(_ROUNDS):
        failed = [k for k, t in targets.items() if not _meets(found.mesh.predicted[k], t)]
        if not failed:
            return found
        for material in failed:
            found = _choose(found, fractions, material, targets[material], name)
    failed = [k for k, t in targets.items() if not _meets(found.mesh.predicted[k], t)]
    if not failed:
        return found
    raise TopologyError(
        f"the wishes contradict each other: {failed[0]!r} has {found.mesh.predicted[failed[0]]} "
        f"instead of {targets[failed[0]]} once the other materials have what is wished for",
        where=f"materials of {name}",
        expected="wishes that can be fulfilled together",
        remedy=f"leave out the wish for {failed[0]!r} or for one of "
        f"{', '.join(repr(k) for k in targets if k != failed[0])}, or use smaller cells",
    )


def _predict(fractions: MaterialFractions, thresholds: dict[str, float], name: str) -> Fulfilled:
    """Return the mesh for given thresholds, divided by the largest one."""
    largest = max(thresholds.values())
    thresholds = {k: t / largest for k, t in thresholds.items()}
    return Fulfilled(mesh_materials(fractions, thresholds=thresholds, name=name), thresholds)


def _choose(
    found: Fulfilled, fractions: MaterialFractions, material: str, target: Target, name: str
) -> Fulfilled:
    """Return the mesh with the best threshold that gives a material its target."""
    values = np.array([found.thresholds[k] for k in fractions.names])
    field = score_field(fractions, fractions.names.index(material), values)
    intervals = _list_intervals(Topology(field).curves)
    wanted = intervals[matches(intervals, target)].sort_values("width", ascending=False)
    tried = set()
    for share in ((wanted["lower"] + wanted["upper"]) / 2).head(_TRIALS):
        thresholds = found.thresholds | {material: share / (1 - share)}
        trial = _predict(fractions, thresholds, name)
        if _meets(trial.mesh.predicted[material], target):
            return trial
        tried.add(str(trial.mesh.predicted[material]))
    order = np.lexsort((-intervals["width"].to_numpy(), distances(intervals, target)))
    nearest = intervals.iloc[order[:_LISTED]]
    raise TopologyError(
        f"no threshold gives the material {material!r} {target}"
        + (f"; those that should give it give {', '.join(sorted(tried))}" if tried else ""),
        where=f"materials of {name}",
        expected="Betti numbers that it can have while the others stay as they are, for instance "
        + ", ".join(dict.fromkeys(map(_in_words, nearest[_BETTI].itertuples(index=False)))),
        remedy=f"wish for one of these, name {material!r} earlier, or use smaller cells",
    )


def _list_intervals(curves: pd.DataFrame) -> pd.DataFrame:
    """Return the runs of plateaus with equal Betti numbers, within the range of thresholds."""
    run = (curves[_BETTI] != curves[_BETTI].shift()).any(axis=1).cumsum()
    grouped = curves.groupby(run)
    intervals = grouped[_BETTI].first()
    intervals["upper"] = grouped["upper"].max().clip(_LOWEST, _HIGHEST)
    intervals["lower"] = grouped["lower"].min().clip(_LOWEST, _HIGHEST)
    intervals["width"] = intervals["upper"] - intervals["lower"]
    return intervals[(intervals["width"] > 0) & (intervals["betti_0"] > 0)]


def _meets(betti: BettiNumbers, target: Target) -> bool:
    """Return whether Betti numbers are as wished for."""
    return bool(matches(pd.DataFrame([betti], columns=_BETTI), target)[0])


def _in_words(betti: tuple[int, ...]) -> str:
    """Return Betti numbers as text."""
    return str(BettiNumbers(*map(int, betti)))
