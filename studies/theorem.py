"""Sweep the paper's theorem on gaps to find where the result depends on offset or orientation.

The closing and opening widths of a patch (`studies.gap_patch`) determine its outcome at every
width.  For a set of orientations and offsets, the result is certain up to the smallest closing
width (always closed) and beyond the largest opening width (always open).  Between them, in the
*window*, it depends on the offset or the orientation, or varies along the gap itself.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pandas as pd

from studies.directions import normals_of
from studies.gap import sample_distances
from studies.gap_kernels import RULES, critical_width
from studies.gap_patch import measure_widths
from tusqh.grid import FloatArray

#: The theorem's windows for cells alone and for cells with sub-cells, and the width below which,
#: according to the theorem, orientation cannot be resolved; in cell sizes.
CLAIMED = {
    "touching": (math.sqrt(2) - 1, 1.0),
    "faces": (math.sqrt(2) - 1, 1.0),
    "filtration": (math.sqrt(2) - 1, math.sqrt(0.5)),
    "sub-cells": (math.sqrt(2) - 1, math.sqrt(0.5)),
}
ORIENTATION_LIMIT = 0.5

#: Samples along the side of a cell; 0 means exact areas and volumes.
SAMPLES = {2: (0, 2, 4, 8, 16), 3: (0, 2, 4)}

#: Cells along the gap.
_LENGTH = {2: 12, 3: 4}

#: Parameters of the search around an end of a window: number of initial orientations, number of
#: rounds, and steps relative to the last spacing.  With samples there are many local optima.
_STARTS = {2: 3, 3: 1}
_ROUNDS = 7
_STEPS = {2: np.linspace(-1.0, 1.0, 7), 3: np.linspace(-1.0, 1.0, 3)}

TIE = 1e-9


def method_name(samples: int) -> str:
    """Return the name in tables of a method that measures fractions.

    Parameters
    ----------
    samples
        Samples along each side of a cell; 0 for exact fractions.

    Examples
    --------
    >>> method_name(0), method_name(4)
    ('exact', 's=4')
    """
    return f"s={samples}" if samples else "exact"


@dataclass(frozen=True)
class Widths:
    """Closing and opening widths of all orientations and offsets.

    Parameters
    ----------
    places
        Coordinates of the orientations, shape (m, dim - 1): in 2D the rotation in degrees, in 3D
        the ratios of the second and third components of the normal to the first.
    offsets
        Offsets, shape (k,), in cell sizes.
    closing, opening
        Widths, shape (m, k, 4), in cell sizes.
    """

    places: FloatArray
    offsets: FloatArray
    closing: FloatArray
    opening: FloatArray


def measure(places: FloatArray, offsets: FloatArray, samples: int) -> Widths:
    """Return the widths of all orientations and offsets with exact fractions or with samples.

    Parameters
    ----------
    places
        Orientations, see `Widths.places`.
    offsets
        Offsets over one period, in cell sizes.
    samples
        Samples along each side of a cell; 0 for exact fractions.
    """
    normals = normals_of(places)
    distances = np.stack([sample_distances(normal, samples) for normal in normals])
    length = _LENGTH[normals.shape[1]]
    closing, opening = measure_widths(normals, offsets, distances, length=length)
    return Widths(places, offsets, closing, opening)


def tabulate_orientations(widths: Widths, samples: int) -> pd.DataFrame:
    """Return the ends of the window over all offsets for every orientation and rule.

    The columns `smallest_closing` and `largest_opening` bound the widths at which the offset
    matters at that orientation; `middle_width` and `crossing_width` are their values for exact
    fractions in closed form: the critical width of a cell centred on the gap, and the
    widest gap that a step can cross.

    Parameters
    ----------
    widths
        The widths of all orientations and offsets.
    samples
        Samples along each side of a cell; 0 for exact fractions.

    Returns
    -------
    pandas.DataFrame
        One row per orientation and rule.
    """
    tables = []
    normals = normals_of(widths.places)
    exact = np.empty(0)
    middle = [critical_width(0.0, normal, exact) for normal in normals]
    for r, rule in enumerate(RULES):
        table = _name_places(widths.places)
        table.insert(0, "scheme", rule)
        table.insert(0, "method", method_name(samples))
        table["smallest_closing"] = widths.closing[:, :, r].min(axis=1)
        table["largest_closing"] = widths.closing[:, :, r].max(axis=1)
        table["smallest_opening"] = widths.opening[:, :, r].min(axis=1)
        table["largest_opening"] = widths.opening[:, :, r].max(axis=1)
        table["middle_width"] = middle
        table["crossing_width"] = crossing_widths(rule, normals)
        tables.append(table)
    return pd.concat(tables, ignore_index=True)


def crossing_widths(rule: str, normals: FloatArray) -> FloatArray:
    """Return the widest gap that a path can cross with exact fractions, in closed form.

    A step along ``d`` crosses the widest gap if it is centred on the gap; that width is the
    critical width of a cell at distance ``n . d / 2``.  Paths step from cell to cell through a face
    (`faces`) or any corner (`touching`), or between a cell and one of its corners, which is half as
    far (`sub-cells`).  In the `filtration`, vertices never help in the plane, because the middle of
    a pinch across a gap lies in the gap; in space they do.

    Parameters
    ----------
    rule
        One of `RULES`.
    normals
        Unit normals, shape (m, dim).

    Examples
    --------
    >>> crossing_widths("touching", np.array([[0.8, 0.6]])).round(3).tolist()
    [1.4]
    """
    to_corner = normals.sum(axis=1)
    to_face = normals.max(axis=1)
    in_filtration = to_face if normals.shape[1] == 2 else np.maximum(to_face, to_corner / 2)
    steps = {"touching": to_corner, "faces": to_face, "filtration": in_filtration}
    exact = np.empty(0)
    pairs = zip(steps.get(rule, to_corner / 2), normals, strict=True)
    return np.array([critical_width(step / 2, normal, exact) for step, normal in pairs])


def tabulate_sweep(widths: Widths, gap_widths: FloatArray, samples: int) -> pd.DataFrame:
    """Return the number of offsets with each outcome, for every width and orientation.

    `depends` states whether there are different outcomes, or an outcome that is mixed along the
    gap.

    Parameters
    ----------
    widths
        The widths of all orientations and offsets.
    gap_widths
        Widths of the gap, in cell sizes.
    samples
        Samples along each side of a cell; 0 for exact fractions.
    """
    tables = []
    for r, rule in enumerate(RULES):
        closing, opening = widths.closing[:, None, :, r], widths.opening[:, None, :, r]
        at = gap_widths[None, :, None]
        n_closed = (at <= closing + TIE).sum(axis=2)
        n_open = (at > opening + TIE).sum(axis=2)
        n_offsets = len(widths.offsets)
        table = _name_places(np.repeat(widths.places, len(gap_widths), axis=0))
        table.insert(0, "width", np.tile(gap_widths, len(widths.places)))
        table.insert(0, "scheme", rule)
        table.insert(0, "method", method_name(samples))
        table["closed"], table["open"] = n_closed.ravel(), n_open.ravel()
        table["mixed"] = n_offsets - table["closed"] - table["open"]
        table["depends"] = table[["closed", "open"]].max(axis=1) < n_offsets
        tables.append(table)
    return pd.concat(tables, ignore_index=True)


def tabulate_windows(widths: Widths, samples: int) -> pd.DataFrame:
    """Return the refined ends of the window of every rule, and the orientations where they occur.

    The result is always closed up to `lower` and always open beyond `upper`.  The width `upper`
    itself is in the window, because a cell that is exactly half full is kept.

    Parameters
    ----------
    widths
        The widths of all orientations and offsets.
    samples
        Samples along each side of a cell; 0 for exact fractions.
    """
    rows = []
    dim = widths.places.shape[1] + 1
    for r, rule in enumerate(RULES):
        for end, values, sign in (
            ("lower", widths.closing[:, :, r], -1),
            ("upper", widths.opening[:, :, r], 1),
        ):
            found, place, offset = _look_closer(widths, values, sign, r, samples)
            rows.append(
                {
                    "dimension": dim,
                    "method": method_name(samples),
                    "scheme": rule,
                    "end": end,
                    "found": round(found, 6),
                    **{k: round(v, 4) for k, v in _name_places(place[None]).iloc[0].items()},
                    "offset": round(offset, 4),
                }
            )
    table = pd.DataFrame(rows)
    if dim == 2:
        claimed = [
            CLAIMED[rule][end == "upper"]
            for rule, end in zip(table["scheme"], table["end"], strict=True)
        ]
        table["claimed"] = np.round(claimed, 6)
        table["difference"] = (table["found"] - table["claimed"]).round(6)
    return table


def _look_closer(
    widths: Widths, values: FloatArray, sign: int, rule: int, samples: int
) -> tuple[float, FloatArray, float]:
    """Return the largest (sign 1) or smallest (-1) width near the best one of a sweep."""
    score = (sign * values).max(axis=1)
    found = []
    for start in np.argsort(-score, kind="stable")[: _STARTS[widths.places.shape[1] + 1]]:
        place = widths.places[start]
        k = int((sign * values[start]).argmax())
        best, offset = float(values[start, k]), float(widths.offsets[k])
        steps = _STEPS[len(place) + 1]
        spread = [_spacing(widths.places), _spacing(widths.offsets[:, None])]
        for _ in range(_ROUNDS):
            around = np.stack(np.meshgrid(*[steps * spread[0]] * len(place), indexing="ij"), -1)
            places = np.unique(_into_range(place + around.reshape(-1, len(place))), axis=0)
            closer = measure(places, offset + steps * spread[1], samples)
            new = (closer.closing if sign < 0 else closer.opening)[:, :, rule]
            at = np.unravel_index(int((sign * new).argmax()), new.shape)
            if sign * new[at] > sign * best:
                best, place, offset = float(new[at]), places[at[0]], float(closer.offsets[at[1]])
            spread = [s / 2 for s in spread]
        found.append((best, place, offset % 1.0))
    return max(found, key=lambda end: sign * end[0])


def _spacing(values: FloatArray) -> float:
    return float(np.diff(np.unique(values)).max())


def _into_range(places: FloatArray) -> FloatArray:
    """Return orientations clipped to the range that represents all orientations up to symmetry."""
    if places.shape[1] == 1:
        return np.clip(places, 0.0, 45.0)
    first = np.clip(places[:, 0], 0.0, 1.0)
    return np.stack([first, np.clip(places[:, 1], 0.0, first)], axis=1)


def _name_places(places: FloatArray) -> pd.DataFrame:
    names = ["degrees"] if places.shape[1] == 1 else ["ratio_2", "ratio_3"]
    return pd.DataFrame(places, columns=names)


def sweep_methods(
    places: FloatArray, offsets: FloatArray, gap_widths: FloatArray
) -> tuple[pd.DataFrame, pd.DataFrame, pd.DataFrame]:
    """Return orientations, sweep and windows for each method that measures fractions.

    Parameters
    ----------
    places
        Orientations, see `Widths`.
    offsets
        Offsets over one period, in cell sizes.
    gap_widths
        Widths of the sweep, in cell sizes.

    Returns
    -------
    orientations, sweep, windows
        The tables of `tabulate_orientations`, `tabulate_sweep` and `tabulate_windows`, with the
        column `method`.
    """
    orientations, sweeps, windows = [], [], []
    for samples in SAMPLES[places.shape[1] + 1]:
        widths = measure(places, offsets, samples)
        orientations.append(tabulate_orientations(widths, samples))
        sweeps.append(tabulate_sweep(widths, gap_widths, samples))
        windows.append(tabulate_windows(widths, samples))
    tables = (pd.concat(t, ignore_index=True) for t in (orientations, sweeps, windows))
    first, second, third = tables
    return first, second, third
