"""Find the rows of the diagram that wishes for features name."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tusqh.errors import TopologyError
from tusqh.grid import FloatArray, IntArray
from tusqh.local_topology.features import Features
from tusqh.local_topology.wishes import OPEN, Wish
from tusqh.settings.features import Feature

#: Largest number of classes that an error lists.
_LISTED = 5


def find_wishes(features: Features, named: Sequence[Feature]) -> tuple[Wish, ...]:
    """Return the wishes for the features that settings name.

    Parameters
    ----------
    features
        The classes at the base.
    named
        The settings.

    Returns
    -------
    wishes
        One for each, in their order; repeated ones are left out.

    Raises
    ------
    TopologyError
        A class does not exist, a point lies outside the grid, or two wishes contradict each other.
    """
    found: dict[int, Wish] = {}
    for about in named:
        row = _by_row(features, about) if about.near is None else _nearest(features, about)
        wish = Wish(row, about.do)
        if found.setdefault(row, wish) != wish:
            raise TopologyError(
                f"{features.describe(row)} shall be both {found[row].do} and {wish.do}",
                where="features",
                expected="one wish for each feature",
                remedy="leave out one of the two, or name another feature by its row",
            )
    return tuple(found.values())


def _by_row(features: Features, about: Feature) -> int:
    """Return the row that is named by its number."""
    row, n = int(about.row or 0), len(features.classes)
    if row >= n:
        raise _missing(
            features, f"row {row} of a diagram with {n} rows", _of_kind(features, about.kind)
        )
    kind, is_there = str(features.classes["class"][row]), bool(features.classes["is_there"][row])
    if about.kind not in (None, kind):
        rows = _by_distance(features, _of_kind(features, about.kind), features.points[row])
        raise _missing(features, f"row {row} is a {kind}, not a {about.kind}", rows)
    if about.do != OPEN and not is_there:
        rows = _by_distance(features, _there(features, kind), features.points[row])
        what = f"{features.describe(row)} is not there, so nothing is to {about.do}"
        raise _missing(features, what, rows)
    return row


def _nearest(features: Features, about: Feature) -> int:
    """Return the row of a kind that is nearest to a point; of equally near ones the longest-lived.

    Only a feature that is there can be cut or filled.
    """
    grid, point = features.grid, np.array(about.near, dtype=float)
    lower, upper = grid.to_points(np.array([[0.0] * grid.dim, [float(n) for n in grid.shape]]))
    text = _in_words(point)
    if len(point) != grid.dim or (point < lower).any() or (point > upper).any():
        raise TopologyError(
            f"the point {text} of a wish lies outside the grid",
            where="features",
            expected=f"a point of {grid.dim} numbers between {_in_words(lower)} and "
            f"{_in_words(upper)}",
            remedy="correct the point, or change the window",
        )
    of_kind = _of_kind if about.do == OPEN else _there
    rows = _by_distance(features, of_kind(features, about.kind), point)
    if len(rows) == 0:
        there = _by_distance(features, _there(features, None), point)
        state = "" if about.do == OPEN else f" at the threshold {features.base:.6g}"
        raise _missing(features, f"there is not a {about.kind}{state}", there)
    return int(rows[0])


def _of_kind(features: Features, kind: str | None) -> IntArray:
    """Return the rows of a kind, or all."""
    is_kind = (features.classes["class"] == kind) | (kind is None)
    return np.flatnonzero(is_kind)


def _there(features: Features, kind: str | None) -> IntArray:
    """Return the rows of a kind that are there at the base."""
    return np.intersect1d(_of_kind(features, kind), np.flatnonzero(features.classes["is_there"]))


def _by_distance(features: Features, rows: IntArray, point: FloatArray) -> IntArray:
    """Return rows, those nearest to a point first."""
    distance = ((features.points[rows] - point) ** 2).sum(axis=1)
    return np.asarray(rows[np.argsort(distance, kind="stable")])


def _missing(features: Features, what: str, rows: IntArray) -> TopologyError:
    """Return the error for a class that does not exist, with others."""
    listed = [features.describe(int(row)) for row in rows[:_LISTED]]
    return TopologyError(
        what,
        where="features",
        expected="a class of the diagram of this grid, such as\n    " + "\n    ".join(listed)
        if listed
        else "a diagram with such a class; that of this grid has none",
        remedy="name one of these by its row, or by its class and a point; another grid has "
        "another diagram",
    )


def _in_words(point: FloatArray) -> str:
    return "(" + ", ".join(f"{x:.6g}" for x in point) + ")"
