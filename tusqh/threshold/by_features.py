"""Take the cells of a base, with single features opened, cut or filled."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import pandas as pd

from tusqh.errors import TopologyError
from tusqh.local_topology.feature_cells import change_features, to_cells
from tusqh.local_topology.features import Features
from tusqh.local_topology.name_features import find_wishes
from tusqh.local_topology.wishes import Wish
from tusqh.settings.features import Feature
from tusqh.threshold.candidates import rank_candidates, try_cells
from tusqh.threshold.describe_choice import describe_choice, find_interval_around
from tusqh.threshold.plateaus import PREDICTED, Plateaus
from tusqh.threshold.selection import Selection


def choose_by_features(
    plateaus: Plateaus, named: Sequence[Feature], base: float, *, name: str
) -> tuple[Selection, pd.DataFrame]:
    """Return the cells of a base with features opened, cut or filled, verified by a mesh.

    Parameters
    ----------
    plateaus
        The plateaus of the threshold.
    named
        The features and what is done about them.
    base
        The threshold of the other cells.
    name
        The model, for messages.

    Returns
    -------
    selection, candidates
        See `tusqh.threshold.choose.choose_threshold`; there are no candidates.

    Raises
    ------
    TopologyError
        A feature does not exist, or a wish is impossible or contradicts another one.
    """
    features = Features(plateaus.cell_sets, base)
    wishes = find_wishes(features, named)
    return take_wishes(plateaus, features, wishes, reason="given", name=name)


def take_wishes(
    plateaus: Plateaus, features: Features, wishes: Sequence[Wish], *, reason: str, name: str
) -> tuple[Selection, pd.DataFrame]:
    """Return the cells of a base after wishes for features, verified by a mesh.

    Parameters
    ----------
    plateaus
        The plateaus of the threshold.
    features
        The classes at the base.
    wishes
        What is done about them, in this order.
    reason
        Why, in words.
    name
        The model, for messages.

    Returns
    -------
    selection, candidates
        See `choose_by_features`.

    Raises
    ------
    TopologyError
        A wish is impossible or contradicts another one.
    """
    cells = to_cells(features, change_features(features, wishes), wishes)
    trial = try_cells(cells, plateaus.cell_sets.fractions.grid, name=name)
    if not trial.is_verified:
        raise TopologyError(
            f"a mesh that does not measure the predicted Betti numbers {cells.predicted}",
            where=name,
            expected="a sound mesh with these Betti numbers",
            remedy="this is a fault of tusqh: please report it with fractions.npz",
        )
    wanted = "; ".join(f"{wish.do} {features.describe(wish.row)}" for wish in wishes)
    selection = describe_choice(
        plateaus,
        {"threshold": features.base},
        cells,
        wanted=f"the threshold {features.base:.6g} with other features: {wanted}",
        reason=reason,
        find_interval=partial(
            find_interval_around, plateaus, features.base, features.space.start.predicted
        ),
        resolved=trial.resolved,
    )
    none = pd.DataFrame(columns=PREDICTED, dtype=float)
    return selection, rank_candidates(none, pd.Series(dtype=bool))
