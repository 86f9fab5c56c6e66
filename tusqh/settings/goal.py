"""The goal: how the threshold is chosen."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from tusqh.settings.features import Feature
from tusqh.settings.field import entries_of, setting
from tusqh.settings.section import Section
from tusqh.settings.validate import Path


@dataclass(frozen=True)
class Range(Section):
    """A range of numbers, including both ends."""

    min: int | None = setting("Smallest number.", default=None, otherwise="any", at_least=0)
    max: int | None = setting("Largest number.", default=None, otherwise="any", at_least=0)

    def find_contradictions(self) -> Iterator[tuple[Path, str, str]]:
        """Yield a range that contains no number."""
        if self.min is not None and self.max is not None and self.min > self.max:
            yield (), f"found {self.to_dict()}", "a range whose min is not above its max"


#: A number, a list of numbers, or a range.
Wanted = int | tuple[int, ...] | Range

Scope = Literal["global", "local"]

#: The base of the local scope: a threshold, or the one with the volume of the geometry.
Base = float | Literal["match"]


@dataclass(frozen=True)
class Target(Section):
    """The Betti numbers that a mesh must have; omitted numbers may have any value.

    Examples
    --------
    >>> print(Target.from_dict({"betti_1": {"min": 1, "max": 3}, "betti_0": [1, 2]}))
    betti_0 in [1, 2], 1 <= betti_1 <= 3
    """

    #: How the option is written.
    option_form: ClassVar[str] = " As 1,0,0; a range is 1..3, and `*` is any number."

    betti_0: Wanted | None = setting(
        "Number of connected components.", default=None, otherwise="any", at_least=0
    )
    betti_1: Wanted | None = setting(
        "Number of holes; in 3D, of tunnels.", default=None, otherwise="any", at_least=0
    )
    betti_2: Wanted | None = setting(
        "Number of voids, in 3D.", default=None, otherwise="any", at_least=0
    )

    def given(self) -> dict[str, Wanted]:
        """Return the Betti numbers that are given, by name."""
        values = {entry.name: getattr(self, entry.name) for entry in entries_of(Target)}
        return {name: wanted for name, wanted in values.items() if wanted is not None}

    def __str__(self) -> str:
        """Return the target in words."""
        return ", ".join(_in_words(name, wanted) for name, wanted in self.given().items())

    @staticmethod
    def from_argument(value: Any) -> Any:
        """Return the value of the argument `betti`, a sequence, as a mapping.

        Parameters
        ----------
        value
            Up to three numbers, lists, ranges, or None for any number.

        Raises
        ------
        ValueError
            The value is of another kind; the message states what is expected.

        Examples
        --------
        >>> Target.from_argument((1, None, {"max": 2}))
        {'betti_0': 1, 'betti_2': {'max': 2}}
        """
        if isinstance(value, (Target, dict)):
            return value
        if isinstance(value, str) or not isinstance(value, Sequence) or not 1 <= len(value) <= 3:
            raise ValueError("up to three Betti numbers, as (1, 0, 0)")
        return {f"betti_{k}": wanted for k, wanted in enumerate(value) if wanted is not None}

    @staticmethod
    def from_option(text: str) -> Any:
        """Return the text of the option ``--betti`` as a mapping.

        Parameters
        ----------
        text
            Numbers and ranges, separated by commas.

        Examples
        --------
        >>> Target.from_option("1,0..2,*")
        {'betti_0': 1, 'betti_1': {'min': 0, 'max': 2}}
        """
        return Target.from_argument([_from_text(entry.strip()) for entry in text.split(",")])

    def to_option(self) -> str:
        """Return the text of the option ``--betti``, in which lists become ranges."""
        return ",".join(_to_text(getattr(self, entry.name)) for entry in entries_of(Target))


@dataclass(frozen=True)
class Goal(Section):
    """The goal: one of these fields, or `volume` together with `target` or `persistence`.

    Examples
    --------
    >>> Goal().threshold, Goal(persistence=0.2).threshold
    (0.5, None)
    >>> Goal().is_local, Goal(persistence=0.2).is_local
    (False, True)
    """

    title: ClassVar[str] = "Threshold"
    alternatives: ClassVar[tuple[str, ...]] = ("threshold", "target", "persistence", "volume")
    combinable: ClassVar[tuple[tuple[str, str], ...]] = (
        ("target", "volume"),
        ("persistence", "volume"),
    )

    threshold: float | None = setting(
        "Keep cells with at least this volume fraction.",
        default=None,
        otherwise=0.5,
        above=0,
        at_most=1,
        metavar="T",
    )
    target: Target | None = setting(
        "Instead of a threshold: the Betti numbers that the mesh must have (numbers of "
        "components, holes and voids). Each is a number, a list of numbers, or a range.",
        default=None,
        argument="betti",
        metavar="B0,B1,B2",
        extra={"minProperties": 1},
    )
    persistence: float | None = setting(
        "Instead of a threshold: keep only features that live over at least this range of "
        "thresholds, by a threshold at which no others live or, where there is none, by removing "
        "and filling exactly those.",
        default=None,
        above=0,
        at_most=1,
        metavar="P",
    )
    volume: Literal["match"] | None = setting(
        "Instead of a threshold: `match` takes the threshold whose mesh has the volume nearest to "
        "that of the geometry; with `target` or `persistence`, among the thresholds that give it.",
        default=None,
    )
    scope: Scope | None = setting(
        "With `target` or `persistence`, or targets of materials: `local` keeps the cells of the "
        "threshold `base`, and adds and leaves out only those that the topology needs (rows of "
        "`changes.csv`); `global` keeps the cells of the one threshold that gives the topology, as "
        "in the paper.",
        default=None,
        otherwise="local",
        needs_one_of=("target", "persistence"),
    )
    features: tuple[Feature, ...] | None = setting(
        "Single features that are kept or made (open), or ended by leaving out (cut) or adding "
        "cells (fill): a row of `diagram.csv`, or the class and the point it is nearest to, as "
        "hole@0.5,1,2; of several materials as ring:3. The other cells are those of the "
        "`threshold`, or with `target` of `base`.",
        default=None,
        otherwise="none",
        words=("open", "cut", "fill"),
        metavar="[MATERIAL:]ROW|CLASS@X,Y",
    )
    base: Base = setting(
        "The threshold whose cells the local scope keeps where it can; `match` takes the one whose "
        "cells have the volume nearest to that of the geometry.",
        default=0.5,
        above=0,
        at_most=1,
        needs={"scope": "local"},
        needs_one_of=("target", "persistence", "features"),
        metavar="T",
    )

    @property
    def is_local(self) -> bool:
        """Whether the mesh keeps the cells of the base except where the topology needs others."""
        asks_for_topology = self.target is not None or self.persistence is not None
        return asks_for_topology and self.scope != "global"

    def find_contradictions(self) -> Iterator[tuple[Path, str, str]]:
        """Yield wishes for features that contradict one another or another goal."""
        yield from super().find_contradictions()
        rows: dict[tuple[str | None, int], str] = {}
        for k, feature in enumerate(self.features or ()):
            for path, found, expected in feature.find_contradictions():
                yield ("features", str(k), *path), found, expected
            key = feature.material, feature.row or 0
            if feature.row is not None and rows.setdefault(key, feature.do) != feature.do:
                found = f"row {feature.row} is in two wishes, {rows[key]} and {feature.do}"
                yield ("features", str(k)), found, "one wish for each feature"
        if self.features and self.scope == "global":
            yield ("features",), "`scope: global` is given too", "the local scope, or no features"
        for other in ("persistence", "volume"):
            if self.features and getattr(self, other) is not None:
                yield ("features",), f"`{other}` is given too", "`threshold` or `target`, or none"


def _in_words(name: str, wanted: Wanted) -> str:
    if isinstance(wanted, Range):
        low = "" if wanted.min is None else f"{wanted.min} <= "
        high = "" if wanted.max is None else f" <= {wanted.max}"
        return f"{low}{name}{high}"
    return f"{name} = {wanted}" if isinstance(wanted, int) else f"{name} in {list(wanted)}"


def _from_text(entry: str) -> Any:
    """Return one entry of ``--betti``: a number, a range ``1..3``, or None for ``*``."""
    low, dots, high = entry.partition("..")
    if entry == "*":
        return None
    try:
        if not dots:
            return int(entry)
        wanted = {key: int(end) for key, end in {"min": low, "max": high}.items() if end}
    except ValueError:
        wanted = {}
    if not wanted:
        raise ValueError(
            "numbers as 1,0,0 for one component without holes and voids, 1..3 for a range, * for "
            "any number"
        )
    return wanted


def _to_text(wanted: Wanted | None) -> str:
    if isinstance(wanted, tuple):
        wanted = Range(min=min(wanted), max=max(wanted))
    if isinstance(wanted, Range):
        low, high = ("" if end is None else end for end in (wanted.min, wanted.max))
        return f"{low}..{high}" if wanted != Range() else "*"
    return "*" if wanted is None else str(wanted)
