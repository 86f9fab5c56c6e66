"""The placement of the background grid and its effect on the volume."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from fractions import Fraction
from typing import Any


@dataclass(frozen=True)
class Placement:
    """The result of comparing several placements of the grid.

    Parameters
    ----------
    moved
        How far the grid was moved along each axis, in samples; all 0 if it stays at the corner.
    samples
        Samples along each side of a cell.
    tried
        Number of placements that were tried; 0 if the grid cannot be moved, 1 if it need not be.
    threshold
        The threshold at which volumes were compared.
    reference_volume
        The volume with which they were compared, in model units.
    error, corner_error
        Relative error of the volume of the kept cells, at this placement and at the corner: the
        larger of the errors with and without the cells whose fraction equals the threshold.
    reason
        Why the grid cannot be moved; empty if it can.
    """

    moved: tuple[int, ...]
    samples: int
    tried: int = 0
    threshold: float = 0.5
    reference_volume: float = 0.0
    error: float = 0.0
    corner_error: float = 0.0
    reason: str = ""

    @property
    def is_moved(self) -> bool:
        """Whether the grid is not at the corner."""
        return any(self.moved)

    def to_dict(self) -> dict[str, Any]:
        """Return the placement as plain values, for JSON."""
        return asdict(self) | {"moved": list(self.moved)}

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> Placement:
        """Return the placement that `to_dict` described.

        Parameters
        ----------
        values
            The fields by name.
        """
        return cls(**{**values, "moved": tuple(values["moved"])})

    def __str__(self) -> str:
        """Return the placement in words.

        Examples
        --------
        >>> print(Placement((1, 2, 1), 4, 64, error=0.008, corner_error=0.041))
        moved by (1/4, 1/2, 1/4) of a cell: volume error 0.8 % rather than 4.1 %
        """
        if self.reason:
            return f"at the corner: {self.reason}"
        if not self.is_moved:
            tried = f", {self.tried} places tried" if self.tried > 1 else ""
            return f"at the corner: volume error {_percent(self.error)}{tried}"
        moved = ", ".join(str(Fraction(step, self.samples)) for step in self.moved)
        return (
            f"moved by ({moved}) of a cell: volume error {_percent(self.error)} rather than "
            f"{_percent(self.corner_error)}"
        )


def _percent(share: float) -> str:
    """Return a share in percent, with one digit."""
    return f"{100 * share:.1f} %"
