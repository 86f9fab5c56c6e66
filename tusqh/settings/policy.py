"""The treatment of archipelagos and small features."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from tusqh.settings.field import setting
from tusqh.settings.section import Section

BridgeMode = Literal["forest", "all", "none"]


@dataclass(frozen=True)
class Criteria(Section):
    """The criteria, all of which a feature (component, hole or void) must meet to stay."""

    title: ClassVar[str] = "Bridges and features"

    min_cells: int = setting("Smallest number of grid cells.", default=1, at_least=1, metavar="N")
    min_volume: float = setting(
        "Smallest area or volume.",
        default=0.0,
        unit="units of the geometry to the power of the dimension",
        at_least=0,
        metavar="V",
    )
    min_persistence: float = setting(
        "Smallest range of volume fractions over which the feature lives.",
        default=0.0,
        at_least=0,
        at_most=1,
        metavar="P",
    )
    keep: int | None = setting(
        "Largest number of features that stay, the longest-lived ones.",
        default=None,
        otherwise="all",
        at_least=0,
        metavar="N",
    )

    @property
    def needs_persistence(self) -> bool:
        """Whether the criteria depend on the persistence of features."""
        return self.min_persistence > 0 or self.keep is not None

    @property
    def keeps_all(self) -> bool:
        """Whether every feature stays."""
        return self == Criteria()


@dataclass(frozen=True)
class Policy(Section):
    """Every setting other than the threshold that determines the mesh of given fractions.

    Examples
    --------
    >>> Policy.from_dict({"components": {"min_cells": 4}}).components.min_cells
    4
    """

    title: ClassVar[str] = "Bridges and features"

    bridges: BridgeMode | None = setting(
        "Join components along interior edges while they are separate (`forest`), along every such "
        "path between different components, which may make holes (`all`), or not at all (`none`).",
        default=None,
        otherwise="forest in 2D, none in 3D",
    )
    components: Criteria = setting(
        "What a component must meet to stay; each removal is a row in `features.csv`.",
        default=Criteria,
    )
    holes: Criteria = setting(
        "2D: what a hole must meet not to be filled; each filling is a row in `features.csv`.",
        default=Criteria,
        prefix="holes-",
        kinds=("outline", "picture"),
    )
    voids: Criteria = setting(
        "3D: what a void must meet not to be filled; each filling is a row in `features.csv`.",
        default=Criteria,
        prefix="voids-",
        kinds=("surface", "image"),
    )

    def bridges_in(self, dim: int) -> BridgeMode:
        """Return which bridges are built: the given ones, else a forest in 2D and none in 3D.

        Parameters
        ----------
        dim
            Dimension of the grid.
        """
        if self.bridges is not None:
            return self.bridges
        return "forest" if dim == 2 else "none"
