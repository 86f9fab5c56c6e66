"""What the user wants done about pinches, archipelagos and small features."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

MixedPinches = Literal["separate", "connect", "majority"]
BridgeMode = Literal["forest", "all", "none"]


@dataclass(frozen=True)
class Criteria:
    """What a feature (a component, a hole, a void) needs to stay; it must meet all of them.

    Parameters
    ----------
    min_cells
        Background-grid cells.
    min_volume
        Model units to the power of the dimension.
    min_persistence
        Range of volume fractions over which the feature lives, dimensionless.
    keep
        At most this many stay, the longest-lived ones; None for any number.
    """

    min_cells: int = 1
    min_volume: float = 0.0
    min_persistence: float = 0.0
    keep: int | None = None

    @property
    def needs_persistence(self) -> bool:
        """Whether the persistence of features decides."""
        return self.min_persistence > 0 or self.keep is not None

    @property
    def keeps_all(self) -> bool:
        """Whether every feature stays."""
        return self == Criteria()


@dataclass(frozen=True)
class Policy:
    """How cells become a mesh, apart from the threshold.

    Parameters
    ----------
    mixed_pinches
        What to do with clusters of pinches that disagree.
    bridges
        Join components along interior edges while they are separate (``"forest"``), along every
        such path between different components (``"all"``), or not at all.
    components
        Components that do not meet these are removed.
    holes
        In 2D: holes that do not meet these are filled.
    voids
        In 3D: voids that do not meet these are filled.
    """

    mixed_pinches: MixedPinches = "separate"
    bridges: BridgeMode = "forest"
    components: Criteria = field(default_factory=Criteria)
    holes: Criteria = field(default_factory=Criteria)
    voids: Criteria = field(default_factory=Criteria)

    @classmethod
    def from_settings(cls, settings: Mapping[str, Any]) -> Policy:
        """Return the policy of a model's block in the configuration.

        >>> Policy.from_settings({"components": {"min_cells": 4}}).components.min_cells
        4
        """
        values = dict(settings)
        for name in ("components", "holes", "voids"):
            if name in values:
                values[name] = Criteria(**values[name])
        return cls(**values)
