"""Choose the threshold within an interval of the same topology: 1/2 or that of the best volume."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from tusqh.grid import FloatArray

#: Least distance of a threshold to the ends of its interval; in a narrow interval, least share of
#: its width.
SAFE_DISTANCE, SAFE_SHARE = 0.05, 0.25

#: The threshold 1/2 is taken if the relative volume error of its cells is at most this.
GOOD = 0.01


def take_threshold_of(members: pd.DataFrame) -> tuple[int, float]:
    """Return the position and value of an interval's threshold: 1/2 or that of the best volume.

    Thresholds closer to an end of the interval than `SAFE_DISTANCE`, or than `SAFE_SHARE` of its
    width if that is less, are excluded.  Among the others, 1/2 is taken if the volume error of its
    cells is at most `GOOD` or at most that of any other; otherwise the middle of the plateau whose
    cells have the nearest volume is taken, and in a tie the one nearest to the middle of the
    interval.  If the volume is unknown, the plateau nearest to the middle of the interval is taken.

    Parameters
    ----------
    members
        The plateaus of the interval from high to low, rows of
        `tusqh.threshold.plateaus.Plateaus.table`.

    Returns
    -------
    index, threshold
        The position of the plateau in `members`, and the threshold.

    Examples
    --------
    >>> members = pd.DataFrame({"upper": [0.9, 0.6, 0.4], "lower": [0.6, 0.4, 0.2],
    ...     "threshold": [0.75, 0.5, 0.3], "volume_ratio": [0.98, 1.005, 1.1]})
    >>> take_threshold_of(members)
    (1, 0.5)
    >>> take_threshold_of(members.assign(volume_ratio=[0.98, 1.05, 1.1]))
    (0, 0.75)
    """
    upper, lower = members["upper"].to_numpy(), members["lower"].to_numpy()
    top, bottom = float(upper[0]), float(lower[-1])
    thresholds = members["threshold"].to_numpy(dtype=float)
    from_middle = np.abs(thresholds - (top + bottom) / 2)
    errors = np.abs(members["volume_ratio"].to_numpy(dtype=float) - 1)
    if np.isnan(errors).any():
        index = int(from_middle.argmin())
        return index, float(thresholds[index])
    is_safe = _is_safe(thresholds, bottom, top)
    if not is_safe.any():
        is_safe = from_middle == from_middle.min()
    best = int(np.lexsort([from_middle, errors, ~is_safe])[0])
    at_half = np.flatnonzero((lower < 0.5) & (upper >= 0.5))
    if len(at_half) and _is_safe(np.array([0.5]), bottom, top)[0]:
        half = int(at_half[0])
        if errors[half] <= max(errors[best], GOOD):
            return half, 0.5
    return best, float(thresholds[best])


def margin_of(same_cells: tuple[float, float], interval: tuple[float, float]) -> float:
    """Return the distance of a set of kept cells to the ends of an interval of thresholds.

    A mesh is the same for every threshold of its plateau, so this is a property of the plateau: it
    is the largest distance that a threshold in the plateau has to the nearer end.

    Parameters
    ----------
    same_cells
        The lower and upper end of the plateau.
    interval
        The lower and upper end of the interval in which the plateau lies.

    Examples
    --------
    Cells with a fraction of exactly 1/2 are kept at all thresholds above 31/64 and up to 1/2:

    >>> margin_of((31 / 64, 0.5), (0.25, 0.5))
    0.015625
    >>> margin_of((0.25, 0.5), (0.25, 0.75))
    0.25
    """
    lower, upper = interval
    best = float(np.clip((lower + upper) / 2, *same_cells))
    return min(best - lower, upper - best)


def describe_place(row: Mapping[str, float] | pd.Series) -> str:
    """Return the reason for the threshold within an interval, in words.

    Parameters
    ----------
    row
        The interval's `threshold` and `volume_ratio`.
    """
    if np.isnan(row["volume_ratio"]):
        return "in its middle, since the volume of the geometry is unknown"
    place = "at 1/2" if row["threshold"] == 0.5 else "where the volume is nearest"
    return f"{place}: its cells have {row['volume_ratio']:.4g} of that of the geometry"


def describe_extent(interval: tuple[float, float], same_cells: tuple[float, float]) -> str:
    """Return how far a threshold can move with the same topology and the same cells, in words.

    Parameters
    ----------
    interval, same_cells
        The lower and upper ends of the two intervals.

    Examples
    --------
    >>> describe_extent((0.25, 0.625), (31 / 64, 0.5))
    'the same topology for 0.25 < t <= 0.625, the same cells for 0.4844 < t <= 0.5'
    """
    topology, cells = (f"{lower:.4g} < t <= {upper:.4g}" for lower, upper in (interval, same_cells))
    if topology == cells:
        return f"the same topology and the same cells for {cells}"
    return f"the same topology for {topology}, the same cells for {cells}"


def _is_safe(thresholds: FloatArray, lower: float, upper: float) -> np.ndarray:
    distance = min(SAFE_DISTANCE, SAFE_SHARE * (upper - lower))
    return np.asarray((thresholds - lower >= distance) & (upper - thresholds >= distance))
