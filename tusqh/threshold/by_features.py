"""Take the cells of a base, with single features opened, cut or filled."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import pandas as pd

from tusqh.errors import TopologyError
from tusqh.local_topology.feature_cells import change_features, to_cells
from tusqh.local_topology.features import Features
from tusqh.local_topology.name_features import find_wishes
from tusqh.local_topology.solver import solve
from tusqh.local_topology.wishes import Wish
from tusqh.settings.features import Feature
from tusqh.settings.goal import Target
from tusqh.threshold.candidates import rank_candidates, try_cells
from tusqh.threshold.describe_choice import describe_choice, find_interval_around
from tusqh.threshold.errors import unreachable_by_features
from tusqh.threshold.goals import distance_to
from tusqh.threshold.plateaus import PREDICTED, Plateaus
from tusqh.threshold.selection import Selection


def choose_by_features(
    plateaus: Plateaus,
    named: Sequence[Feature],
    base: float,
    *,
    target: Target | None = None,
    name: str,
) -> tuple[Selection, pd.DataFrame]:
    """Return the cells of a base with features opened, cut or filled, verified by a mesh.

    With a target, further features are chosen so that the mesh has it, those with the least price.

    Parameters
    ----------
    plateaus
        The plateaus of the threshold.
    named
        The features and what is done about them.
    base
        The threshold of the other cells.
    target
        The Betti numbers that the mesh must have; None: any.
    name
        The model, for messages.

    Returns
    -------
    selection, candidates
        See `tusqh.threshold.choose.choose_threshold`; there are no candidates.

    Raises
    ------
    TopologyError
        A feature does not exist, a wish is impossible or contradicts another one, or no choice of
        cuts and fills gives the target.
    """
    features = Features(plateaus.cell_sets, base)
    given = find_wishes(features, named)
    in_words = "; ".join(f"{wish.do} {features.describe(wish.row)}" for wish in given)
    if target is None:
        wanted = f"the threshold {base:.6g} with other features: {in_words}"
        return _take(plateaus, features, given, wanted=wanted, reason="given", name=name)
    start = change_features(features, given)
    found = solve(features, start, distance_to(target), frozenset(wish.row for wish in given))
    if found.distance > 0:
        raise unreachable_by_features(plateaus.table, features, found.done.betti, target, name=name)
    chosen = [wish for wish, _ in found.done.steps[len(start.steps) :]]
    n_cells = sum(len(changed) for _, changed in found.done.steps)
    return _take(
        plateaus,
        features,
        [*given, *chosen],
        wanted=f"{target}; {in_words}" if given else str(target),
        reason=f"the cheapest choice of features, {len(chosen)} of them, at the base; "
        f"{n_cells:,} cells change",
        name=name,
    )


def _take(
    plateaus: Plateaus,
    features: Features,
    wishes: Sequence[Wish],
    *,
    wanted: str,
    reason: str,
    name: str,
) -> tuple[Selection, pd.DataFrame]:
    """Return the cells of a base after wishes for features, verified by a mesh."""
    cells = to_cells(features, change_features(features, wishes), wishes)
    trial = try_cells(cells, plateaus.cell_sets.fractions.grid, name=name)
    if not trial.is_verified:
        raise TopologyError(
            f"a mesh that does not measure the predicted Betti numbers {cells.predicted}",
            where=name,
            expected="a sound mesh with these Betti numbers",
            remedy="this is a fault of tusqh: please report it with fractions.npz",
        )
    selection = describe_choice(
        plateaus,
        {"threshold": features.base},
        cells,
        wanted=wanted,
        reason=reason,
        find_interval=partial(
            find_interval_around, plateaus, features.base, features.space.start.predicted
        ),
        resolved=trial.resolved,
    )
    none = pd.DataFrame(columns=PREDICTED, dtype=float)
    return selection, rank_candidates(none, pd.Series(dtype=bool))
