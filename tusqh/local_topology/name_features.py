"""Find the rows of the diagram that wishes for features name."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tusqh.errors import TopologyError
from tusqh.grid import FloatArray, IntArray
from tusqh.local_topology.changeable import Changeable, S
from tusqh.local_topology.wishes import OPEN, Wish
from tusqh.settings.features import Feature

#: Largest number of classes that an error lists.
_LISTED = 5
#: How far outside the grid a point may be by rounding, in cells.
_ROUNDING = 1e-9


def find_wishes(features: Changeable[S], named: Sequence[Feature]) -> tuple[Wish, ...]:
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


def _by_row(features: Changeable[S], about: Feature) -> int:
    """Return the row that is named by its number."""
    number, known = int(about.row or 0), features.rows_of(about.material)
    if number >= len(known):
        raise _missing(
            features,
            f"row {number} of a diagram with {len(known)} rows",
            _of_kind(features, known, about.kind),
        )
    row = int(known[number])
    kind, is_there = str(features.classes["class"][row]), bool(features.classes["is_there"][row])
    if about.kind not in (None, kind):
        rows = _by_distance(features, _of_kind(features, known, about.kind), features.points[row])
        raise _missing(features, f"row {number} is a {kind}, not a {about.kind}", rows)
    if about.do != OPEN and not is_there:
        rows = _by_distance(features, _there(features, known, kind), features.points[row])
        what = f"{features.describe(row)} is not there, so nothing is to {about.do}"
        raise _missing(features, what, rows)
    return row


def _nearest(features: Changeable[S], about: Feature) -> int:
    """Return the row of a kind that is nearest to a point; of equally near ones the longest-lived.

    Only a feature that is there can be cut or filled.
    """
    grid, point = features.grid, np.array(about.near, dtype=float)
    corners = np.array(list(np.ndindex((2,) * grid.dim))) * grid.shape
    lower, upper = (end(grid.to_points(corners), axis=0) for end in (np.min, np.max))
    text, place = _in_words(point), np.full((1, grid.dim), np.nan)
    if len(point) == grid.dim:
        place = grid.to_lattice(point[None])
    if not ((place >= -_ROUNDING) & (place <= np.add(grid.shape, _ROUNDING))).all():
        raise TopologyError(
            f"the point {text} of a wish lies outside the grid",
            where="features",
            expected=f"a point of {grid.dim} numbers between {_in_words(lower)} and "
            f"{_in_words(upper)}",
            remedy="correct the point, or change the window",
        )
    known, of_kind = features.rows_of(about.material), _of_kind if about.do == OPEN else _there
    rows = _by_distance(features, of_kind(features, known, about.kind), point)
    if len(rows) == 0:
        there = _by_distance(features, _there(features, known, None), point)
        state = "" if about.do == OPEN else f" at {features.where}"
        raise _missing(features, f"there is not a {about.kind}{state}", there)
    return int(rows[0])


def _of_kind(features: Changeable[S], known: IntArray, kind: str | None) -> IntArray:
    """Return the rows of a kind among known ones, or all of them."""
    is_kind = (features.classes["class"].to_numpy()[known] == kind) | (kind is None)
    return np.asarray(known[is_kind])


def _there(features: Changeable[S], known: IntArray, kind: str | None) -> IntArray:
    """Return the rows of a kind that are there at the base."""
    rows = _of_kind(features, known, kind)
    return np.asarray(rows[features.classes["is_there"].to_numpy()[rows]])


def _by_distance(features: Changeable[S], rows: IntArray, point: FloatArray) -> IntArray:
    """Return rows, those nearest to a point first."""
    distance = ((features.points[rows] - point) ** 2).sum(axis=1)
    return np.asarray(rows[np.argsort(distance, kind="stable")])


def _missing(features: Changeable[S], what: str, rows: IntArray) -> TopologyError:
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
