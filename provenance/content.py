"""The content of a file, independent of its encoding: compression, last digits, order of rows.

A content consists of a skeleton (texts and integers), which must be equal, and of real numbers,
which may differ by a tolerance.  `provenance.read_content` reads it from a file.
"""

from __future__ import annotations

import hashlib
import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from tusqh.grid import FloatArray
from tusqh.hashing import hash_value

#: If there are more numbers than this, a sketch summarises them.
MAX_NUMBERS = 20
_N_SUMS = 2
#: Number of stored digits, which suffices for the smallest tolerance in use.
_DIGITS = 12
#: A number with a decimal point or an exponent; integers belong to the skeleton.
_REAL = re.compile(
    r"(?<![\w.])[-+]?(?:\d+\.\d*|\.\d+|\d+(?=[eE][-+]?\d))(?:[eE][-+]?\d+)?(?![\w.])"
)
#: Columns with this word in their name hold relative errors, all of whose digits are rounding
#: errors, so their differences are absolute.
_ERROR = "error"
#: Numbers below this fraction of the largest one in their column are zero up to rounding.
_PART_OF_COLUMN = 1e-6


@dataclass(frozen=True)
class Numbers:
    """Real numbers of one kind: a column, a field, coordinates.

    Parameters
    ----------
    values : (n,) float64
        The numbers, or a sketch of them if there are more than `MAX_NUMBERS`.
    scale
        Differences are relative to the larger of this scale and the number itself.  The scale is
        the largest number of a field, or a small fraction of the largest number of a column.
    """

    values: FloatArray
    scale: float

    @staticmethod
    def of(values: FloatArray, *, part: float = 1.0) -> Numbers:
        """Return numbers whose scale is a fraction of the largest finite number.

        Parameters
        ----------
        values
            The numbers.
        part
            Ratio of the scale to the largest finite number.
        """
        flat = np.asarray(values, dtype=np.float64).ravel()
        largest = float(np.abs(flat[np.isfinite(flat)]).max(initial=0.0))
        return Numbers(sketch(flat), part * largest)

    def difference(self, other: Numbers) -> float:
        """Return the largest relative difference, inf if the numbers are not comparable.

        Parameters
        ----------
        other
            The numbers to compare with.
        """
        if len(self.values) != len(other.values):
            return float("inf")
        same = (self.values == other.values) | (np.isnan(self.values) & np.isnan(other.values))
        one, two = self.values[~same], other.values[~same]
        if not (np.isfinite(one) & np.isfinite(two)).all():
            return float("inf")
        scale = np.maximum(np.maximum(np.abs(one), np.abs(two)), max(self.scale, other.scale))
        return float((np.abs(one - two) / scale).max(initial=0.0))


@dataclass(frozen=True)
class Content:
    """The content of a file.

    Parameters
    ----------
    skeleton
        SHA-256 of everything except real numbers: texts, integers, connectivity.
    numbers
        The real numbers by column, field or similar name.
    """

    skeleton: str
    numbers: dict[str, Numbers]

    def to_dict(self) -> dict[str, Any]:
        """Return plain values for JSON, with infinities and NaN as texts."""
        return {
            "skeleton": self.skeleton,
            "numbers": {
                name: {
                    "scale": _plain(group.scale),
                    "values": [_plain(x) for x in group.values.tolist()],
                }
                for name, group in self.numbers.items()
            },
        }

    @staticmethod
    def from_dict(values: dict[str, Any]) -> Content:
        """Return the content that `to_dict` describes.

        Parameters
        ----------
        values
            The plain values that `to_dict` returned.
        """
        numbers = {
            name: Numbers(np.array([float(x) for x in group["values"]]), group["scale"])
            for name, group in values["numbers"].items()
        }
        return Content(values["skeleton"], numbers)

    def difference(self, other: Content) -> tuple[float, str]:
        """Return the largest relative difference and its place; inf if texts differ.

        Parameters
        ----------
        other
            The content to compare with.

        Returns
        -------
        difference, place
            The largest relative difference, and the name of the array or text with it.

        Examples
        --------
        >>> one, other = (content_of_table([["mass"], [m]]) for m in ("2.0", "2.5"))
        >>> one.difference(other)
        (0.2, 'mass')
        """
        if self.skeleton != other.skeleton or self.numbers.keys() != other.numbers.keys():
            return float("inf"), "texts or whole numbers"
        return max(
            ((group.difference(other.numbers[name]), name) for name, group in self.numbers.items()),
            default=(0.0, ""),
        )


def sketch(numbers: FloatArray) -> FloatArray:
    """Return up to `MAX_NUMBERS` numbers unchanged, or a summary of more numbers.

    The summary consists of the count, the range, and sums with fixed random signs; it keeps the
    lock small.  A change of one number changes each sum by the same amount, and changes that cancel
    in one sum are unlikely to cancel in the other.

    Parameters
    ----------
    numbers
        Any numbers, as one array.

    Examples
    --------
    >>> sketch(np.array([1.0, 2.0])).tolist()
    [1.0, 2.0]
    >>> len(sketch(np.zeros(10_000)))
    5
    """
    if len(numbers) <= MAX_NUMBERS:
        return numbers
    signs = np.random.default_rng(0).integers(0, 2, (_N_SUMS, len(numbers)), dtype=np.int8) * 2 - 1
    # A matrix product would depend on the BLAS in use.
    sums = [float((row * numbers).sum()) for row in signs]
    return np.array([numbers.size, numbers.min(), numbers.max(), *sums], dtype=np.float64)


def _plain(number: float) -> float | str:
    """Return a number rounded for the lock; infinities and NaN become text, as JSON lacks them."""
    return float(f"{number:.{_DIGITS}g}") if np.isfinite(number) else str(number)


def content_of_table(rows: list[list[str]]) -> Content:
    """Return the content of a table, independent of the order of its rows.

    Parameters
    ----------
    rows
        The cells of each row as texts; the first row is the header.
    """
    header, body = rows[0] if rows else [], rows[1:]
    # Rounding keeps noise in the last digits from changing the order of the rows.
    body = sorted(body, key=lambda row: [_REAL.sub(lambda m: f"{float(m[0]):.6g}", c) for c in row])
    numbers: dict[str, list[float]] = {}
    skeleton = [header]
    for row in body:
        skeleton.append([])
        for k, cell in enumerate(row):
            name = header[k].strip() if k < len(header) else str(k)
            is_real = _REAL.fullmatch(cell.strip()) is not None
            skeleton[-1].append("#" if is_real else cell.strip())
            if is_real:
                numbers.setdefault(name, []).append(float(cell))
    groups = {
        name: Numbers(sketch(np.array(values)), 1.0)
        if _ERROR in name
        else Numbers.of(np.array(values), part=_PART_OF_COLUMN)
        for name, values in numbers.items()
    }
    return Content(hash_value(skeleton), groups)


def content_of_arrays(arrays: dict[str, Any]) -> Content:
    """Return the content of named arrays; real arrays are numbers, all others are skeleton.

    Parameters
    ----------
    arrays
        The arrays by name.
    """
    skeleton: dict[str, Any] = {}
    numbers = {}
    for name, values in sorted(arrays.items()):
        array = np.asarray(values)
        if array.dtype.kind == "f":
            skeleton[name] = list(array.shape)
            numbers[name] = Numbers.of(array)
        elif array.dtype.kind == "U":
            skeleton[name] = array.tolist()
        else:
            whole = np.ascontiguousarray(array, dtype=np.int64)
            skeleton[name] = [*whole.shape, hashlib.sha256(whole.tobytes()).hexdigest()]
    return Content(hash_value(skeleton), numbers)


def content_of_text(text: str, *, is_scaled: bool) -> Content:
    """Return the content of a text.

    Parameters
    ----------
    text
        The text.
    is_scaled
        Whether differences of real numbers are relative to the largest number instead of the number
        itself.
    """
    values = np.array([float(token) for token in _REAL.findall(text)], dtype=np.float64)
    numbers = Numbers.of(values, part=1.0 if is_scaled else 0.0)
    return Content(hash_value(_REAL.sub("#", text)), {"numbers": numbers})
