"""What a file says, apart from how it is written down: compression, last digits, order of rows.

The content is a skeleton, which must be equal, and real numbers, which may differ by a tolerance.
"""

from __future__ import annotations

import ast
import csv
import hashlib
import io
import re
import tokenize
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from provenance.code import syntax_digest
from tusqh.grid import FloatArray
from tusqh.hashing import hash_value

#: More numbers than this are summarised by a sketch.
MAX_NUMBERS = 20
_N_SUMS = 2
#: Enough for the strictest tolerance.
_DIGITS = 12
#: A number with a decimal point or an exponent; whole numbers belong to the skeleton.
_REAL = re.compile(
    r"(?<![\w.])[-+]?(?:\d+\.\d*|\.\d+|\d+(?=[eE][-+]?\d))(?:[eE][-+]?\d+)?(?![\w.])"
)
#: Digests and sizes of other files inside a file: those files are compared themselves.
_OF_OTHER_FILES = re.compile(r'"(sha256|contentSize)": "?\w+"?')
#: Relative errors are compared on the scale of 1: rounding makes all of their digits.
_ERROR = "error"
#: What is this small in a column is zero but for rounding; rows may be of different kinds.
_PART_OF_COLUMN = 1e-6


@dataclass(frozen=True)
class Numbers:
    """Real numbers of one kind: a column, a field, coordinates.

    Parameters
    ----------
    values : (n,) float64
        The numbers, or a sketch of them when there are more than `MAX_NUMBERS`.
    scale
        Differences are relative to the number itself, or to this where that is larger: all of the
        largest number of a field, a small part of that of a column of a table.
    """

    values: FloatArray
    scale: float

    @staticmethod
    def of(values: FloatArray, *, part: float = 1.0) -> Numbers:
        """Return numbers on the scale of a part of the largest."""
        flat = np.asarray(values, dtype=np.float64).ravel()
        largest = float(np.abs(flat[np.isfinite(flat)]).max(initial=0.0))
        return Numbers(sketch(flat), part * largest)

    def difference(self, other: Numbers) -> float:
        """Return the largest relative difference; inf when not comparable."""
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
    """What a file says.

    Parameters
    ----------
    skeleton
        SHA-256 of everything but real numbers: texts, whole numbers, connectivity.
    numbers
        The real numbers by column, field or the like.
    """

    skeleton: str
    numbers: dict[str, Numbers]

    def to_dict(self) -> dict[str, Any]:
        """Return plain values for JSON; infinities and missing values as texts."""
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
        """Return the content that `to_dict` gave."""
        numbers = {
            name: Numbers(np.array([float(x) for x in group["values"]]), group["scale"])
            for name, group in values["numbers"].items()
        }
        return Content(values["skeleton"], numbers)

    def difference(self, other: Content) -> tuple[float, str]:
        """Return how far two contents are apart, and in which numbers; inf when not comparable.

        >>> one, other = (of_table([["mass"], [m]]) for m in ("2.0", "2.5"))
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
    """Return few numbers themselves; of many their count, range and sums with random signs.

    A change of one number changes every sum by as much, and changes that cancel in one sum do not
    in the others.

    >>> sketch(np.array([1.0, 2.0])).tolist()
    [1.0, 2.0]
    >>> len(sketch(np.zeros(10_000)))
    5
    """
    if len(numbers) <= MAX_NUMBERS:
        return numbers
    signs = np.random.default_rng(0).integers(0, 2, (_N_SUMS, len(numbers)), dtype=np.int8) * 2 - 1
    # Not a matrix product: that depends on the BLAS in use.
    sums = [float((row * numbers).sum()) for row in signs]
    return np.array([numbers.size, numbers.min(), numbers.max(), *sums], dtype=np.float64)


def _plain(number: float) -> float | str:
    """Return a number rounded for the lock, or its name where JSON has no such number."""
    return float(f"{number:.{_DIGITS}g}") if np.isfinite(number) else str(number)


def read_content(path: Path) -> Content | None:
    """Return what a file says, None for kinds of files that are only compared byte by byte.

    Meshes are read up to the numbering of points and elements, tables up to the order of rows.
    """
    from provenance import content_of_meshes

    if path.suffix == ".csv":
        with path.open(encoding="utf-8", newline="") as stream:
            return of_table(list(csv.reader(stream)))
    if path.suffix == ".md":
        return of_table([line.split("|") for line in path.read_text("utf-8").splitlines()])
    if path.suffix == ".json":
        return _of_text(_OF_OTHER_FILES.sub(r'"\1": "#"', path.read_text("utf-8")), scaled=False)
    if path.suffix in {".mesh", ".inp", ".pvd"}:
        return _of_text(path.read_text("utf-8"), scaled=True)
    if path.suffix == ".npz":
        with np.load(path) as file:
            return of_arrays({name: file[name] for name in file.files})
    if path.suffix == ".py":
        return Content(syntax_digest(path.read_bytes()), {})
    if path.suffix == ".smk" or path.name == "Snakefile":
        return _of_workflow(path.read_bytes())
    if path.suffix in {".vtu", ".vtp"}:
        return content_of_meshes.of_vtk(path)
    if path.suffix in {".msh", ".exo"}:
        return content_of_meshes.of_meshio(path)
    return None


def of_table(rows: list[list[str]]) -> Content:
    """Return the content of a table given by its cells, the first row being the header."""
    header, body = rows[0] if rows else [], rows[1:]
    # Rounded, so that noise in the last digits leaves the order of rows alone.
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


def of_arrays(arrays: dict[str, Any]) -> Content:
    """Return the content of named arrays: real ones are numbers, all others skeleton."""
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


def _of_text(text: str, *, scaled: bool) -> Content:
    values = np.array([float(token) for token in _REAL.findall(text)], dtype=np.float64)
    numbers = Numbers.of(values, part=1.0 if scaled else 0.0)
    return Content(hash_value(_REAL.sub("#", text)), {"numbers": numbers})


def _of_workflow(source: bytes) -> Content:
    """Return the content of Snakemake code: its words, without comments, docstrings and layout."""
    words: list[tuple[int, str]] = []
    for token in tokenize.tokenize(io.BytesIO(source).readline):
        kind, text = token.type, token.string
        if kind in (tokenize.COMMENT, tokenize.NL) or text.startswith('"""'):
            continue
        if kind == tokenize.INDENT:
            text = ""  # However deep.
        if kind == tokenize.STRING:
            text = ast.dump(ast.parse(text, mode="eval"))  # Whatever its quotes.
        if kind == tokenize.OP and text in ")]}" and words[-1][1] == ",":
            words.pop()
        words.append((kind, text))
    return Content(hash_value(words), {})
