"""Compare Betti numbers with a target."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pandas as pd

from tusqh.grid import BoolArray, FloatArray
from tusqh.settings.goal import Range, Target
from tusqh.topology.betti_numbers import BettiNumbers


def matches(numbers: pd.DataFrame, target: Target) -> BoolArray:
    """Return which rows have the target Betti numbers; omitted numbers may have any value.

    Parameters
    ----------
    numbers
        Betti numbers, in columns `betti_0`, `betti_1` and `betti_2`.
    target
        The wanted ones.

    Examples
    --------
    >>> rows = pd.DataFrame({"betti_0": [1, 1, 2], "betti_1": [0, 3, 5]})
    >>> matches(rows, Target(betti_0=1, betti_1=Range(min=1))).tolist()
    [False, True, False]
    >>> matches(rows, Target(betti_1=(0, 5))).tolist()
    [True, False, True]
    """
    return np.asarray(distances(numbers, target) == 0)


def distance_to(target: Target) -> Callable[[tuple[int, ...]], float]:
    """Return a function that gives the distance of Betti numbers to a target, see `distances`.

    Parameters
    ----------
    target
        The wanted ones.

    Examples
    --------
    >>> distance_to(Target(betti_0=1, betti_1=Range(min=3)))((2, 1, 0))
    3.0
    """

    def distance(betti: tuple[int, ...]) -> float:
        return float(distances(pd.DataFrame([betti], columns=BettiNumbers._fields), target)[0])

    return cache(distance)


def distances(numbers: pd.DataFrame, target: Target) -> FloatArray:
    """Return the distance of the Betti numbers in each row to a target, summed over dimensions.

    Parameters
    ----------
    numbers
        Betti numbers, in columns `betti_0`, `betti_1` and `betti_2`.
    target
        The wanted ones.
    """
    total = np.zeros(len(numbers))
    for name, wanted in target.given().items():
        values = numbers[name].to_numpy(dtype=float)
        if isinstance(wanted, Range):
            low = -np.inf if wanted.min is None else wanted.min
            high = np.inf if wanted.max is None else wanted.max
            total += np.maximum(low - values, 0.0) + np.maximum(values - high, 0.0)
        else:
            options = np.atleast_1d(np.asarray(wanted, dtype=float))
            total += np.abs(values[:, None] - options).min(axis=1)
    return total
