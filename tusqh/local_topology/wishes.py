"""What shall be done about single classes of the diagram."""

from __future__ import annotations

from typing import NamedTuple

#: What can be done about a class.
OPEN, CUT, FILL = "open", "cut", "fill"


class Wish(NamedTuple):
    """What shall be done about a class.

    Parameters
    ----------
    row
        Row of the class in the diagram.
    do
        `OPEN`, `CUT` or `FILL`.
    """

    row: int
    do: str
