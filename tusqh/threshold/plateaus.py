"""Predict the topology of the mesh at every threshold, as plateaus and as intervals."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd

from tusqh.antialias.cells import CellSets
from tusqh.contacts.one_material_contacts import count_contacts
from tusqh.grid import FloatArray, IntArray, doubled
from tusqh.progress import Progress
from tusqh.sampling.doubled_grid import RESOLUTION
from tusqh.sampling.reference import Reference
from tusqh.threshold.within_interval import margin_of, take_threshold_of

BETTI = ["betti_0", "betti_1", "betti_2"]

#: Columns of `Plateaus.table`.
PREDICTED = ["upper", "lower", "width", "threshold", "cells", "contacts", "bridges"]
PREDICTED += ["removed", "filled", *BETTI, "volume_ratio"]
PREDICTED += [*(f"raw_{name}" for name in BETTI), "raw_agrees"]

#: Fields of open outlines have tens of thousands of plateaus, nearly all too narrow to be a
#: robust choice.  These are the limits on the number examined: the largest number applies to small
#: grids, and fewer are examined on large grids, where each one takes longer.
MAX_PLATEAUS = 1000
MIN_PLATEAUS = 100
_CELLS_TO_EXAMINE = 20_000_000


class Plateaus:
    """The plateaus of the threshold and the topology of their meshes, predicted when needed.

    If there are too many plateaus, only the widest ones (up to half of the limit), the plateau of
    1/2 and evenly spread others are examined.

    Parameters
    ----------
    cell_sets
        The cells of every threshold.
    reference
        The volume that a mesh should have; None: that of the fractions.
    progress
        Reports how many plateaus have been examined when all are; None: no report.
    """

    def __init__(
        self,
        cell_sets: CellSets,
        *,
        reference: Reference | None = None,
        progress: Progress | None = None,
    ) -> None:
        self.cell_sets = cell_sets
        fractions = cell_sets.fractions
        self.reference = reference or Reference(fractions.volume(), "the winding-number volume")
        self._progress = progress
        levels = np.append(cell_sets.distinct_fractions, 0.0)
        if levels[0] < 1.0:
            levels = np.append(1.0, levels)
        examined = _choose(levels[:-1], levels[1:], cell_sets.fractions.grid.n_cells)
        self.upper, self.lower = levels[:-1][examined], levels[1:][examined]
        self._rows: dict[int, dict[str, float]] = {}

    def __len__(self) -> int:
        """Return the number of plateaus that are examined."""
        return len(self.upper)

    @cached_property
    def table(self) -> pd.DataFrame:
        """Every examined plateau with the predicted Betti numbers of its mesh.

        There is one row per plateau, from high to low: `upper` and `lower` (every threshold ``t``
        with ``lower < t <= upper`` gives the same mesh); `width`; `threshold`, its middle; the
        number of `cells` kept, of `contacts`, of `bridges`, of components `removed` and of holes or
        voids `filled`; `betti_0`, `betti_1`, `betti_2` of the mesh; `volume_ratio`, the ratio of
        the kept cells' volume to that of the geometry, NaN if the latter is unknown;
        ``raw_betti_*`` of the filtration; `raw_agrees`, whether the filtration and the mesh have
        the same Betti numbers.
        """
        report = self._progress("plateaus") if self._progress else None
        for index in range(len(self)):
            self._examine(index)
            if report is not None:
                report(index + 1, len(self))
        predicted = self._tabulate(slice(0, len(self)))
        for name, numbers in zip(BETTI, self._raw.T, strict=True):
            predicted[f"raw_{name}"] = numbers
        raw_numbers = predicted[[f"raw_{name}" for name in BETTI]].to_numpy()
        predicted["raw_agrees"] = (raw_numbers == predicted[BETTI].to_numpy()).all(axis=1)
        return predicted

    def find_interval(self, threshold: float) -> pd.Series | None:
        """Return the run of plateaus around a threshold whose meshes have the same Betti numbers.

        Only the plateaus of the run and its two neighbours are examined.

        Parameters
        ----------
        threshold
            Volume fraction in (0, 1].

        Returns
        -------
        interval
            A row of `merge_intervals`; None if the threshold lies on a plateau that keeps no cell,
            or between examined plateaus with different Betti numbers.
        """
        last = int(np.searchsorted(-self.lower, -threshold, side="right"))
        if last == len(self):
            return None
        # In a gap between examined plateaus, both neighbours must belong to the run.
        first = last if threshold <= self.upper[last] else last - 1
        if first < 0 or self._kind(first) != self._kind(last) or self._kind(first)[0] == 0:
            return None
        while first > 0 and self._kind(first - 1) == self._kind(last):
            first -= 1
        while last + 1 < len(self) and self._kind(last + 1) == self._kind(first):
            last += 1
        return merge_intervals(self._tabulate(slice(first, last + 1))).iloc[0].copy()

    def _kind(self, index: int) -> tuple[float, ...]:
        """Return whether a plateau keeps cells, and its Betti numbers."""
        row = self._examine(index)
        return (row["cells"] > 0, *(row[name] for name in BETTI))

    def _examine(self, index: int) -> dict[str, float]:
        """Return the prediction for one plateau.

        Every contact follows its vote, so the numbers are those of the filtration where neither
        features nor bridges change the cells.
        """
        if index not in self._rows:
            threshold = self._thresholds[index]
            raw = self._raw[index].tolist()
            if self.cell_sets.follows_filtration(raw[0]):
                n_cells, n_contacts = self._counts[index].tolist()
                changes, betti = (0, 0, 0), raw
            else:
                cells = self.cell_sets.at(threshold)
                n_cells, n_contacts = int(cells.kept.sum()), cells.n_contacts
                changes = cells.n_bridges, cells.n_removed, cells.n_filled
                betti = list(cells.predicted)
            self._rows[index] = {
                "threshold": threshold,
                "cells": n_cells,
                "contacts": n_contacts,
                **dict(zip(("bridges", "removed", "filled"), changes, strict=True)),
                **dict(zip(BETTI, betti, strict=True)),
                "volume_ratio": self._volume_ratio(n_cells),
            }
        return self._rows[index]

    @cached_property
    def _thresholds(self) -> FloatArray:
        """The middle of every plateau."""
        return np.asarray((self.upper + self.lower) / 2)

    @cached_property
    def _raw(self) -> IntArray:
        """Betti numbers of the filtration at every plateau, shape (number of plateaus, 3)."""
        # Plateaus go from high to low; the first with a lower end below it holds the threshold.
        curves = self.cell_sets.topology.curves
        row = np.searchsorted(-curves["lower"].to_numpy(), -self.upper, side="right")
        return curves[BETTI].to_numpy(dtype=np.int64)[row]

    @cached_property
    def _counts(self) -> IntArray:
        """Numbers of cells and of contacts at every plateau, shape (number of plateaus, 2)."""
        fractions = self.cell_sets.fractions
        least = np.ceil(self._thresholds / RESOLUTION).astype(np.int64)
        cells = np.sort(fractions.multiples[doubled.cells(fractions.grid.dim)].ravel())
        n_cells = len(cells) - np.searchsorted(cells, least)
        n_contacts = count_contacts(fractions.multiples, least[::-1])[::-1]
        return np.stack([n_cells, n_contacts], axis=1)

    def _volume_ratio(self, n_cells: int) -> float:
        if self.reference.volume <= 0:
            return float("nan")
        grid = self.cell_sets.fractions.grid
        return n_cells * grid.cell_size**grid.dim / self.reference.volume

    def _tabulate(self, part: slice) -> pd.DataFrame:
        upper, lower = self.upper[part], self.lower[part]
        extent = pd.DataFrame({"upper": upper, "lower": lower, "width": upper - lower})
        rows = pd.DataFrame([self._examine(index) for index in range(part.start, part.stop)])
        return pd.concat([extent, rows], axis=1)


def merge_intervals(
    predicted: pd.DataFrame, is_wanted: pd.Series | None = None, *, at: float | None = None
) -> pd.DataFrame:
    """Return the runs of plateaus whose meshes have the same Betti numbers.

    Parameters
    ----------
    predicted
        See `Plateaus.table`.
    is_wanted
        Plateaus to use, by default all that keep a cell; other plateaus end a run.
    at
        A threshold that is taken instead, in the run with its plateau.

    Returns
    -------
    intervals
        One row per run, from high to low: `upper`, `lower`, `width`; `unexamined`, the width
        within it that no examined plateau covers; `threshold`, see
        `tusqh.threshold.within_interval.take_threshold_of`; `margin`, the distance of its cells to
        the ends of the run, see `tusqh.threshold.within_interval.margin_of`; and the columns of
        the plateau of that threshold.

    Examples
    --------
    >>> predicted = pd.DataFrame({
    ...     "upper": [1.0, 0.5, 0.25], "lower": [0.5, 0.25, 0.0], "width": [0.5, 0.25, 0.25],
    ...     "threshold": [0.75, 0.375, 0.125], "cells": [3, 4, 5], "volume_ratio": [0.75, 1, 1.25],
    ...     "betti_0": [1, 1, 2], "betti_1": [0, 0, 0], "betti_2": [0, 0, 0]})
    >>> merge_intervals(predicted)[["upper", "lower", "threshold", "margin"]].values.tolist()
    [[1.0, 0.25, 0.5, 0.25], [0.25, 0.0, 0.125, 0.125]]
    """
    use = (predicted["cells"] > 0).to_numpy()
    if is_wanted is not None:
        use = use & is_wanted.to_numpy()
    betti = predicted[BETTI].to_numpy()
    begins = np.ones(len(predicted), dtype=bool)
    begins[1:] = (betti[1:] != betti[:-1]).any(axis=1) | (use[1:] != use[:-1])
    run = np.cumsum(begins) - 1
    rows = []
    for _, members in predicted[use].groupby(run[use], sort=True):
        upper, lower = float(members["upper"].iloc[0]), float(members["lower"].iloc[-1])
        index, threshold = take_threshold_of(members)
        if at is not None:
            holds_it = ((members["lower"] < at) & (members["upper"] >= at)).to_numpy()
            if holds_it.any():
                index, threshold = int(holds_it.argmax()), at
        plateau: dict[str, Any] = {str(k): v for k, v in members.iloc[index].items()}
        same = members[members["cells"] == plateau["cells"]]
        same_cells = float(same["lower"].iloc[-1]), float(same["upper"].iloc[0])
        extent = {
            "threshold": threshold,
            "upper": upper,
            "lower": lower,
            "width": upper - lower,
            "margin": margin_of(same_cells, (lower, upper)),
            "unexamined": max(0.0, upper - lower - float(members["width"].sum())),
            "plateaus": len(members),
        }
        rows.append({**{k: v for k, v in plateau.items() if k not in extent}, **extent})
    columns = ["threshold", "upper", "lower", "width", "margin", "unexamined", "plateaus"]
    columns += [c for c in predicted.columns if c not in columns]
    return pd.DataFrame(rows, columns=columns)


def list_reachable(predicted: pd.DataFrame) -> str:
    """Return the reachable Betti numbers as lines of text, one per interval, from high to low.

    Parameters
    ----------
    predicted
        See `Plateaus.table`.
    """
    return list_intervals(merge_intervals(predicted))


def list_intervals(intervals: pd.DataFrame) -> str:
    """Return the Betti numbers of intervals as lines of text, in their order.

    Parameters
    ----------
    intervals
        See `merge_intervals`.
    """
    return "\n".join(
        f"    {row.lower:.4f} < t <= {row.upper:.4f}: betti_0 = {row.betti_0}, "
        f"betti_1 = {row.betti_1}, betti_2 = {row.betti_2}"
        for row in intervals.itertuples()
    )


def _choose(upper: FloatArray, lower: FloatArray, n_cells: int) -> IntArray:
    """Return the plateaus to examine: all, or the widest, that of 1/2, and evenly spread ones."""
    limit = int(np.clip(_CELLS_TO_EXAMINE // n_cells, MIN_PLATEAUS, MAX_PLATEAUS))
    if len(upper) <= limit:
        return np.arange(len(upper), dtype=np.int64)
    widest = np.argsort(lower - upper, kind="stable")[: limit // 2]
    n_spread = limit - len(widest) - 1
    thresholds = np.append((np.arange(n_spread) + 0.5) / n_spread, 0.5)
    # Plateaus go from high to low; the first with a lower end below a threshold holds it.
    spread = np.searchsorted(-lower, -thresholds, side="right")
    return np.unique(np.concatenate([widest, spread])).astype(np.int64)
