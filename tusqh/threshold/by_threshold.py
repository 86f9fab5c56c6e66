"""Take a given threshold, and find how far it can move."""

from __future__ import annotations

from functools import partial

import pandas as pd

from tusqh.threshold.candidates import rank_candidates
from tusqh.threshold.describe_choice import describe_choice, find_interval_around
from tusqh.threshold.errors import nothing_kept, threshold_out_of_range
from tusqh.threshold.plateaus import PREDICTED, Plateaus
from tusqh.threshold.selection import Selection


def take_threshold(
    plateaus: Plateaus, threshold: float, *, name: str
) -> tuple[Selection, pd.DataFrame]:
    """Return a given threshold without meshing; its interval is computed when needed.

    Parameters
    ----------
    plateaus
        The plateaus of the threshold; those in its interval are examined when needed.
    threshold
        Volume fraction in (0, 1].
    name
        The model, for messages.

    Returns
    -------
    selection, candidates
        See `tusqh.threshold.choose.choose_threshold`; there are no candidates.

    Raises
    ------
    TopologyError
        The threshold is out of range or keeps no cell.
    """
    if not 0 < threshold <= 1:
        raise threshold_out_of_range(threshold, name)
    cell_sets = plateaus.cell_sets
    cells = cell_sets.at(threshold)
    if not cells.kept.any():
        raise nothing_kept(cell_sets, threshold, name)
    selection = describe_choice(
        plateaus,
        {"threshold": threshold},
        cells,
        wanted=f"the threshold {threshold:g}",
        reason="given",
        find_interval=partial(find_interval_around, plateaus, threshold, cells.predicted),
    )
    none = pd.DataFrame(columns=PREDICTED, dtype=float)
    return selection, rank_candidates(none, pd.Series(dtype=bool))
