"""Give several materials the Betti numbers and features wished for.

The materials with targets are taken in the user's order.  For each, the Betti numbers of its score
field (`tusqh.contacts.score_field`) at every threshold give intervals with the target, the widest
first, and the first one that is confirmed by the prediction of the mesh is taken.  As the choice
changes the scores of the others, this is repeated until all wishes hold.

With the local scope, the cells then keep the materials that they have at the base, the given
thresholds, except where the topology needs others (`tusqh.local_topology.relabel`).  Targets that
no thresholds reach, and wishes for features, are met by opening, cutting and filling single classes
of the base (`tusqh.local_topology.material_features`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from tusqh.contacts import MaterialFractions, MaterialMesh, mesh_materials
from tusqh.contacts.mesh import round_thresholds
from tusqh.contacts.score_field import score_field
from tusqh.errors import TopologyError
from tusqh.local_topology.feature_cells import change_features
from tusqh.local_topology.local_labels import LocalLabels, MaterialWish, label_locally, to_labels
from tusqh.local_topology.material_features import MaterialDone, MaterialFeatures
from tusqh.local_topology.name_features import find_wishes
from tusqh.local_topology.solver import solve
from tusqh.settings.features import Feature
from tusqh.settings.goal import Target
from tusqh.settings.materials import Material
from tusqh.threshold.goals import distance_to, distances, matches
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
    base
        The thresholds of the base; None: all cells are those of `thresholds`.
    local
        The materials of cells near to the base; None: there is none.
    """

    mesh: MaterialMesh
    thresholds: dict[str, float]
    base: dict[str, float] | None = None
    local: LocalLabels | None = None


def fulfil(
    fractions: MaterialFractions,
    wishes: Sequence[Material],
    *,
    features: Sequence[Feature] = (),
    is_local: bool = True,
    name: str,
) -> Fulfilled:
    """Return the mesh of materials with the thresholds, Betti numbers and features wished for.

    Parameters
    ----------
    fractions
        Fractions of all materials.
    wishes
        Materials with a threshold or a target; the others have the threshold 1.
    features
        Single features that are opened, cut or filled.
    is_local
        Whether the cells stay near those of the base.
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
    base = _predict(fractions, thresholds, name)
    if features:
        return _by_features(base, fractions, targets, features, name)
    try:
        found = _by_thresholds(base, fractions, targets, name)
    except TopologyError as reason:
        if not is_local:
            raise
        return _by_features(base, fractions, targets, (), name, reason=reason)
    if not (is_local and targets):
        return found
    local = label_locally(fractions, found.thresholds, base.thresholds)
    mesh = mesh_materials(fractions, thresholds=found.thresholds, labels=local.labels, name=name)
    if mesh.predicted != found.mesh.predicted:
        raise _changed(name)
    return Fulfilled(mesh, found.thresholds, base.thresholds, local)


def _by_features(
    base: Fulfilled,
    fractions: MaterialFractions,
    targets: dict[str, Target],
    features: Sequence[Feature],
    name: str,
    *,
    reason: TopologyError | None = None,
) -> Fulfilled:
    """Return the mesh of a base with features opened, cut or filled, so that targets hold."""
    named = {f.material for f in features} | set(targets)
    if None in named or not named <= {*fractions.names[:-1]}:
        named = set(fractions.names)  # The error lists all materials.
    classes = MaterialFeatures(
        fractions,
        round_thresholds(fractions.names, base.thresholds),
        [n for n in fractions.names[:-1] if n in named],
    )
    given = find_wishes(classes, features)
    start = change_features(classes, given)
    solution = solve(
        classes, start, _distance(fractions, targets), frozenset(wish.row for wish in given)
    )
    if solution.distance > 0:
        raise _unreachable(solution.done, fractions, targets, name, reason)
    every = [*given, *(wish for wish, _ in solution.done.steps[len(start.steps) :])]
    steps = tuple(
        MaterialWish(str(about["material"]), int(about["row"]), do)
        for about, do in ((classes.classes.iloc[row], do) for row, do in every)
    )
    local = to_labels(classes, change_features(classes, every), steps)
    mesh = mesh_materials(fractions, thresholds=base.thresholds, labels=local.labels, name=name)
    return Fulfilled(mesh, base.thresholds, base.thresholds, local)


def _distance(
    fractions: MaterialFractions, targets: dict[str, Target]
) -> Callable[[tuple[int, ...]], float]:
    """Return the sum of the distances of the Betti numbers of materials to their targets."""
    one = [(fractions.names.index(k), distance_to(target)) for k, target in targets.items()]

    def distance(betti: tuple[int, ...]) -> float:
        return sum(of(tuple(betti[3 * k : 3 * k + 3])) for k, of in one)

    return distance


def _by_thresholds(
    found: Fulfilled, fractions: MaterialFractions, targets: dict[str, Target], name: str
) -> Fulfilled:
    """Return the mesh for thresholds that give every target."""
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


def _unreachable(
    nearest: MaterialDone,
    fractions: MaterialFractions,
    targets: dict[str, Target],
    name: str,
    reason: TopologyError | None,
) -> TopologyError:
    """Return the error for targets that neither thresholds nor features reach."""
    found = ", ".join(
        f"{k!r} {BettiNumbers(*nearest.of(fractions.names.index(k)))}" for k in targets
    )
    wanted = ", ".join(f"{k!r} {target}" for k, target in targets.items())
    expected = f"Betti numbers that can be reached; the nearest found with features are {found}"
    if any(target.betti_0 == 0 for target in targets.values()):
        expected += " (a material has at least one component)"
    return TopologyError(
        f"no features opened, cut or filled at the base give {wanted}"
        if reason is None
        else f"{reason.found}, and no features opened, cut or filled at the base do",
        where=f"materials of {name}",
        expected=expected if reason is None else f"{expected}. By thresholds, {reason.expected}",
        remedy="wish for these, name features (`--open`, `--cut`, `--fill`), whose prices are in "
        "prices.csv, or use smaller cells",
    )


def _changed(name: str) -> TopologyError:
    """Return the error for a topology that simple relabellings have changed."""
    return TopologyError(
        "other Betti numbers after simple relabellings of cells",
        where=f"materials of {name}",
        expected="the Betti numbers of the start",
        remedy="this is a fault of tusqh: please report it with fractions.npz",
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
