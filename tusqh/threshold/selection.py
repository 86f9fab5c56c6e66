"""The chosen threshold, the reason for the choice, and its robustness."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple, Self

from tusqh.antialias.cells import CellSet
from tusqh.antialias.resolve import Resolved
from tusqh.local_topology.wishes import Wish
from tusqh.settings.policy import Policy
from tusqh.threshold.within_interval import describe_extent
from tusqh.topology.betti_numbers import BettiNumbers


class Interval(NamedTuple):
    """An interval of thresholds with the same Betti numbers.

    Parameters
    ----------
    lower, upper
        Every examined threshold ``t`` with ``lower < t <= upper`` has these Betti numbers.
    margin
        Distance of the kept cells to the nearer end, see
        `tusqh.threshold.within_interval.margin_of`.
    unexamined
        Width within the interval that no examined plateau covers.
    """

    lower: float
    upper: float
    margin: float
    unexamined: float


@dataclasses.dataclass(frozen=True)
class Selection:
    """A threshold, the reason for its choice, and the robustness of the choice.

    Parameters
    ----------
    threshold
        The threshold, dimensionless, in (0, 1].
    cells_lower, cells_upper
        Every threshold ``t`` with ``cells_lower < t <= cells_upper`` gives the same cells.
    wanted
        The request, in words.
    raw
        Betti numbers of the filtration, which are those of a mesh that follows all votes.
    predicted
        Predicted Betti numbers of the mesh.
    reason
        Why the threshold was chosen, in one sentence.
    policy
        How small features were treated, which may differ from the settings.
    base
        The threshold whose cells were kept except where the topology needs others; None if the
        cells are those of `threshold`.
    wishes
        The single features that were opened, cut or filled.
    find_interval, find_without_features
        Functions that compute `interval` and `without_features`.
    cells
        The cells, if they are known; they are not stored in files.
    resolved
        The mesh, if one was made to verify the choice; it is not stored in files.
    """

    threshold: float
    cells_lower: float
    cells_upper: float
    wanted: str
    raw: BettiNumbers
    predicted: BettiNumbers
    reason: str
    policy: Policy
    find_interval: Callable[[], Interval] = dataclasses.field(compare=False, repr=False)
    find_without_features: Callable[[], str] = dataclasses.field(
        default=str, compare=False, repr=False
    )
    base: float | None = None
    wishes: tuple[Wish, ...] = ()
    cells: CellSet | None = dataclasses.field(default=None, compare=False, repr=False)
    resolved: Resolved | None = dataclasses.field(default=None, compare=False, repr=False)

    @cached_property
    def interval(self) -> Interval:
        """The interval around the threshold; for a given threshold its plateaus are examined."""
        return self.find_interval()

    @property
    def margin(self) -> float:
        """Distance of the kept cells to the nearer end of the interval."""
        return self.interval.margin

    @property
    def extent(self) -> str:
        """How far the threshold can move with the same topology and the same cells, in words."""
        return describe_extent(self.interval[:2], (self.cells_lower, self.cells_upper))

    @cached_property
    def without_features(self) -> str:
        """The thresholds that give the same Betti numbers with no feature removed or filled.

        The text is empty if no threshold does, or if the choice removes and fills nothing.  All
        plateaus are examined to find it.
        """
        return self.find_without_features()

    def to_dict(self) -> dict[str, Any]:
        """Return the selection as plain values for JSON, without the mesh."""
        return {
            "threshold": self.threshold,
            "base": self.base,
            "features": [wish._asdict() for wish in self.wishes],
            **self.interval._asdict(),
            "cells_lower": self.cells_lower,
            "cells_upper": self.cells_upper,
            "wanted": self.wanted,
            "raw": list(self.raw),
            "predicted": list(self.predicted),
            "reason": self.reason,
            "without_features": self.without_features,
            "policy": dataclasses.asdict(self.policy),
        }

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Self:
        """Return the selection that `to_dict` described.

        Parameters
        ----------
        values
            Plain values, for instance the content of selection.json.
        """
        given = dict(values)
        without_features = str(given.pop("without_features"))
        for key in ("raw", "predicted"):
            given[key] = BettiNumbers(*given[key])
        given["wishes"] = tuple(Wish(**wish) for wish in given.pop("features"))
        given["policy"] = Policy.from_dict(given["policy"])
        interval = Interval(**{key: given.pop(key) for key in Interval._fields})
        return cls(
            **given,
            find_interval=lambda: interval,
            find_without_features=lambda: without_features,
        )


def load_selection(path: Path) -> Selection:
    """Return the selection in a selection.json.

    Parameters
    ----------
    path
        The file.
    """
    return Selection.from_dict(json.loads(path.read_text(encoding="utf-8")))
