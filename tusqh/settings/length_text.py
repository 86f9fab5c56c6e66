"""Lengths in the settings: numbers in the model's unit, or numbers with a unit."""

from __future__ import annotations

import re

#: How a length is written, for sentences.
FORM = "in the model's unit, in cells (`0.5 cells`), or with a unit (`2 mm`)"

_TEXT = re.compile(r"\s*([0-9]*\.?[0-9]+(?:[eE][-+]?[0-9]+)?)\s*([A-Za-zµμ -]*?)\s*")

#: Words for the size of a cell.
CELLS = ("cell", "cells")


def split_length(text: str) -> tuple[float, str] | None:
    """Return the number and the unit of a length, or None if the text is not a positive length.

    Parameters
    ----------
    text
        The text.

    Returns
    -------
    length
        The number and the unit, which may be empty.

    Examples
    --------
    >>> split_length("2 mm"), split_length("0.5cells"), split_length("2"), split_length("mm")
    ((2.0, 'mm'), (0.5, 'cells'), (2.0, ''), None)
    """
    found = _TEXT.fullmatch(text)
    if found is None or not 0 < float(found[1]) < float("inf"):
        return None
    return float(found[1]), found[2]


def is_length(text: str) -> bool:
    """Return whether a text is a positive number, with a unit or without.

    Parameters
    ----------
    text
        The text.
    """
    return split_length(text) is not None
