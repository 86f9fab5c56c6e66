"""A kind of defect, and the table of all kinds for one geometry."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import pandas as pd

from tusqh.geometry.units import in_unit

Facts = TypeVar("Facts")

#: Units of measures: the model unit to a power, or none.
LENGTH, AREA, VOLUME, DIMENSIONLESS = "model units", "model units^2", "model units^3", "-"

#: The measure of a defect that is only counted.
NOT_MEASURED = float("nan")

#: Columns of the table of defects, for every kind of geometry.
DEFECT_COLUMNS = ["defect", "count", "measure", "unit", "explanation"]


@dataclass(frozen=True)
class Defect(Generic[Facts]):
    """A kind of defect of a geometry.

    Parameters
    ----------
    name
        Name in the column ``defect``.
    unit
        Unit of its measure.
    explanation
        What is counted; after a semicolon, what is measured.
    find
        Function that returns count and measure from the facts of a geometry.
    """

    name: str
    unit: str
    explanation: str
    find: Callable[[Facts], tuple[int, float]]


def defect(
    unit: str, explanation: str
) -> Callable[[Callable[[Facts], tuple[int, float]]], Defect[Facts]]:
    """Return a decorator that makes a `Defect` of the function that finds it.

    The defect has the name of the function, without its leading underscore.

    Parameters
    ----------
    unit
        Unit of its measure.
    explanation
        What is counted; after a semicolon, what is measured.
    """

    def decorate(find: Callable[[Facts], tuple[int, float]]) -> Defect[Facts]:
        return Defect(find.__name__.lstrip("_"), unit, explanation, find)

    return decorate


def tabulate_defects(
    defects: Sequence[Defect[Facts]], facts: Facts, *, unit: str = ""
) -> pd.DataFrame:
    """Return one row per kind of defect, found or not, in the order given.

    Parameters
    ----------
    defects
        The kinds.
    facts
        The facts from which they are determined.
    unit
        Unit of length of the geometry; empty if it is not known.

    Returns
    -------
    pandas.DataFrame
        With the columns `DEFECT_COLUMNS`.
    """
    rows = [(d.name, *d.find(facts), in_unit(d.unit, unit), d.explanation) for d in defects]
    table = pd.DataFrame(rows, columns=DEFECT_COLUMNS)
    return table.astype({"count": "int64", "measure": "float64"})
