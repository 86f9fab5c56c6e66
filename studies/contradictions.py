"""List the points of a sweep over gaps that contradict the paper's theorem."""

from __future__ import annotations

import numpy as np
import pandas as pd

from studies.directions import normals_of
from studies.gap_kernels import critical_width
from studies.theorem import CLAIMED, TIE, crossing_widths


def list_contradictions(sweep: pd.DataFrame) -> pd.DataFrame:
    """Return the points of a sweep that contradict the theorem, with the reason.

    The theorem gives two windows, one for cells alone (`touching`, `faces`) and one for cells with
    sub-cells (`filtration`, `sub-cells`).  Outside the windows every offset must give the same
    result.

    Parameters
    ----------
    sweep
        The table of `tabulate_sweep`.
    """
    lower = sweep["scheme"].map(lambda rule: CLAIMED[rule][0])
    upper = sweep["scheme"].map(lambda rule: CLAIMED[rule][1])
    n_offsets = sweep[["closed", "open", "mixed"]].sum(axis=1)
    too_early = (sweep["width"] <= lower) & (sweep["closed"] < n_offsets)
    # With sub-cells the upper end itself is outside the window; without them it is inside.
    strict = sweep["scheme"].isin(["filtration", "sub-cells"])
    is_beyond = (sweep["width"] > upper) | (strict & (sweep["width"] == upper))
    too_late = is_beyond & (sweep["open"] < n_offsets)
    rows = sweep[too_early | too_late].copy()
    rows["why"] = [
        _explain(*row)
        for row in zip(rows["method"], rows["scheme"], rows["width"], rows["degrees"], strict=True)
    ]
    return rows.reset_index(drop=True)


def _explain(method: str, rule: str, width: float, degrees: float) -> str:
    """Return the reason why a point contradicts the theorem."""
    normal = normals_of(np.array([[degrees]]))
    closes = critical_width(0.0, normal[0], np.empty(0))
    if closes < width <= crossing_widths(rule, normal)[0] + TIE:
        return {
            "touching": "two kept cells touch at a corner across the gap: a pinch joins them",
            "faces": "two kept cells share a face across the gap",
            "filtration": "two kept cells share a face across the gap: sub-cells cannot cut it",
            "sub-cells": "a cell and a vertex just half full face each other: a tie",
        }[rule]
    return f"{method}: a fraction by samples is off by up to one row of them"
