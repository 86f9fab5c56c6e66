"""The placement of the background grid and its effect on the volume."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from fractions import Fraction
from typing import Any

#: What a placement has only where the settings ask for it.
_AS_SET = ("offset", "requested", "taken", "planes")


@dataclass(frozen=True)
class GridPlane:
    """A plane with faces of the geometry, and its distance from the nearest plane of the grid.

    Parameters
    ----------
    axis
        The axis of the grid that it is perpendicular to: x, y or z.
    at
        Its coordinate, in model units.
    share
        Share of the area of the geometry (2D: of its length) that lies in it.
    away
        Distance from the nearest plane of the grid, in cells; 0 if it lies on it.
    """

    axis: str
    at: float
    share: float
    away: float


@dataclass(frozen=True)
class Placement:
    """The result of comparing several placements of the grid, or how the settings place it.

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
    offset
        How far the settings move the grid from the corner along each axis, in cells; empty if
        they do not.
    requested, taken
        With planes: the edge lengths of a cell before and after, in model units.
    planes
        The planes of the geometry on which the grid was to be laid; none if it was not.
    """

    moved: tuple[int, ...]
    samples: int
    tried: int = 0
    threshold: float = 0.5
    reference_volume: float = 0.0
    error: float = 0.0
    corner_error: float = 0.0
    reason: str = ""
    offset: tuple[float, ...] = ()
    requested: tuple[float, ...] = ()
    taken: tuple[float, ...] = ()
    planes: tuple[GridPlane, ...] = ()

    @property
    def is_moved(self) -> bool:
        """Whether comparing placements moved the grid away from the corner."""
        return any(self.moved)

    def to_dict(self) -> dict[str, Any]:
        """Return the placement as plain values, for JSON, without what the settings do not ask."""
        values = asdict(self)
        lists = {name: list(values[name]) for name in ("moved", *_AS_SET)}
        unused = [name for name in _AS_SET if not lists[name]]
        return {name: v for name, v in (values | lists).items() if name not in unused}

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> Placement:
        """Return the placement that `to_dict` described.

        Parameters
        ----------
        values
            The fields by name.
        """
        planes = tuple(GridPlane(**plane) for plane in values.get("planes", ()))
        tuples = {name: tuple(values.get(name, ())) for name in ("moved", *_AS_SET)}
        return cls(**{**values, **tuples, "planes": planes})

    def __str__(self) -> str:
        """Return the placement in words.

        Examples
        --------
        >>> print(Placement((1, 2, 1), 4, 64, error=0.008, corner_error=0.041))
        moved by (1/4, 1/2, 1/4) of a cell: volume error 0.8 % rather than 4.1 %
        """
        if self.planes:
            return self._in_planes()
        if self.offset:
            moved = ", ".join(f"{step:g}" for step in self.offset)
            return f"moved by ({moved}) of a cell, as `offset` asks"
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

    def _in_planes(self) -> str:
        """Return the planes of the geometry that lie on planes of the grid, and the others."""
        total = sum(plane.share for plane in self.planes)
        on_grid = [plane for plane in self.planes if plane.away == 0]
        share = sum(plane.share for plane in on_grid) / total
        off = [
            f"{plane.axis} = {plane.at:.6g} is {plane.away:.2g} cells off"
            for plane in self.planes
            if plane.away
        ]
        listed = ", ".join(f"{plane.axis} = {plane.at:.6g}" for plane in on_grid)
        text = (
            f"{len(on_grid)} of {len(self.planes)} planes of the geometry lie on planes of the "
            f"grid ({100 * share:.0f} % of their area): {listed}"
        )
        if self.taken != self.requested:
            taken, requested = (
                " x ".join(f"{x:.6g}" for x in dict.fromkeys(sizes))
                for sizes in (self.taken, self.requested)
            )
            text = f"cells of {taken} instead of {requested}: {text}"
        return "; ".join([text, *off])


def _percent(share: float) -> str:
    """Return a share in percent, with one digit."""
    return f"{100 * share:.1f} %"
