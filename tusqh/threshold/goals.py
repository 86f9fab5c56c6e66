"""What a user may ask for: Betti numbers as values, lists or ranges."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from tusqh.grid import BoolArray, FloatArray
from tusqh.topology.betti_numbers import BettiNumbers

#: A number, a list of numbers, or a range with ``min``, ``max`` or both.
Wanted = int | list[int] | dict[str, int]
Target = Mapping[str, Wanted]


def matches(numbers: pd.DataFrame, target: Target) -> BoolArray:
    """Return which rows have the wanted Betti numbers; those left out may have any value.

    Examples
    --------
    >>> rows = pd.DataFrame({"betti_0": [1, 1, 2], "betti_1": [0, 3, 5]})
    >>> matches(rows, {"betti_0": 1, "betti_1": {"min": 1}}).tolist()
    [False, True, False]
    >>> matches(rows, {"betti_1": [0, 5]}).tolist()
    [True, False, True]
    """
    return np.asarray(distances(numbers, target) == 0)


def distances(numbers: pd.DataFrame, target: Target) -> FloatArray:
    """Return how far the Betti numbers of each row are from a target, summed over dimensions."""
    total = np.zeros(len(numbers))
    for name, wanted in target.items():
        values = numbers[name].to_numpy(dtype=float)
        if isinstance(wanted, dict):
            total += np.maximum(wanted.get("min", -np.inf) - values, 0.0)
            total += np.maximum(values - wanted.get("max", np.inf), 0.0)
        else:
            options = np.atleast_1d(np.asarray(wanted, dtype=float))
            total += np.abs(values[:, None] - options).min(axis=1)
    return total


def is_met(betti: BettiNumbers, target: Target) -> bool:
    """Return whether Betti numbers are as wanted."""
    return bool(matches(pd.DataFrame([betti._asdict()]), target)[0])


def find_empty(target: Target) -> str | None:
    """Return the name of a range that holds no number, None where there is none.

    >>> find_empty({"betti_0": 1, "betti_1": {"min": 3, "max": 1}})
    'betti_1'
    """
    ranges = {name: wanted for name, wanted in target.items() if isinstance(wanted, dict)}
    return next((n for n, r in ranges.items() if r.get("min", 0) > r.get("max", np.inf)), None)


def describe(target: Target) -> str:
    """Return a target in words.

    >>> describe({"betti_1": {"min": 1, "max": 3}, "betti_0": [1, 2]})
    'betti_0 in [1, 2], 1 <= betti_1 <= 3'
    """
    words = []
    for name, wanted in sorted(target.items()):
        if isinstance(wanted, dict):
            low = f"{wanted['min']} <= " if "min" in wanted else ""
            high = f" <= {wanted['max']}" if "max" in wanted else ""
            words.append(f"{low}{name}{high}")
        elif isinstance(wanted, list):
            words.append(f"{name} in {wanted}")
        else:
            words.append(f"{name} = {wanted}")
    return ", ".join(words)
