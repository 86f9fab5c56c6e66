"""Wishes for single features: a component, hole or void that is opened, cut or filled."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from tusqh.settings.field import setting
from tusqh.settings.section import Section
from tusqh.settings.validate import Path

_FORM = "a row of diagram.csv, as 3, or a class and a point, as hole@0.5,1,2; with several "
_FORM += "materials, the name of the material comes first, as ring:3"


@dataclass(frozen=True)
class Feature(Section):
    """A class of the persistence diagram, and what is done about it.

    Examples
    --------
    >>> Feature.from_dict({"near": [0, 0, 1], "class": "hole", "do": "fill"}).to_option()
    'hole@0,0,1'
    """

    title: ClassVar[str] = "Features"

    do: Literal["open", "cut", "fill"] = setting(
        "`open` keeps the feature, or makes one that is not there; `cut` ends it by leaving cells "
        "out, `fill` by adding some.",
    )
    row: int | None = setting(
        "Row of the feature in `diagram.csv`, from 0; of several materials in `prices.csv`.",
        default=None,
        otherwise="the one nearest to `near`",
        at_least=0,
    )
    kind: Literal["component", "hole", "void"] | None = setting(
        "Kind of the feature.", default=None, otherwise="that of the row", key="class"
    )
    near: tuple[float, ...] | None = setting(
        "Point near the feature: near the fullest cell of a component, near the middle of a hole "
        "or void.",
        default=None,
        otherwise="the `row` says which",
        unit="units of the geometry",
        n_items=(2, 3),
    )

    material: str | None = setting(
        "With several materials: the one whose feature it is.",
        default=None,
        otherwise="the only one",
    )

    def find_contradictions(self) -> Iterator[tuple[Path, str, str]]:
        """Yield a feature that is named in two ways or in none, and a point without a class."""
        if (self.row is None) == (self.near is None):
            found = "`row` and `near` are given" if self.near else "neither `row` nor `near`"
            yield (), found, "one of the two"
        elif self.near is not None and self.kind is None:
            yield (), "`near` without `class`", "`class`: component, hole or void"

    @staticmethod
    def from_option(word: str, text: str) -> dict[str, Any]:
        """Return the text of an option ``--open``, ``--cut`` or ``--fill`` as a mapping.

        Parameters
        ----------
        word
            What to do.
        text
            A row, or a class and a point.

        Raises
        ------
        ValueError
            The text is of another kind; the message states what is expected.

        Examples
        --------
        >>> Feature.from_option("fill", "hole@0,0,1")
        {'do': 'fill', 'class': 'hole', 'near': [0.0, 0.0, 1.0]}
        >>> Feature.from_option("cut", "ring:3")
        {'do': 'cut', 'material': 'ring', 'row': 3}
        """
        material, of, feature = text.strip().rpartition(":")
        kind, at, point = feature.partition("@")
        named = {"do": word} | ({"material": material} if of else {})
        try:
            if not at:
                return {**named, "row": int(kind)}
            near = [float(number) for number in point.split(",")]
        except ValueError:
            raise ValueError(_FORM) from None
        return {**named, "class": kind, "near": near}

    def to_option(self) -> str:
        """Return the text of the option ``--open``, ``--cut`` or ``--fill``."""
        of = "" if self.material is None else f"{self.material}:"
        if self.near is None:
            return f"{of}{self.row}"
        return f"{of}{self.kind}@" + ",".join(repr(x).removesuffix(".0") for x in self.near)
