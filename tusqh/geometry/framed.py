"""Geometry in the coordinates of a grid whose axes are turned or whose cells are boxes."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

from tusqh.geometry.kinds import Geometry
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup import Soup
from tusqh.grid.frame import Frame

AnyGeometry = TypeVar("AnyGeometry", bound=Geometry)


def to_frame(geometry: AnyGeometry, frame: Frame) -> AnyGeometry:
    """Return a geometry in the coordinates of a grid; of the same frame, always the same object.

    Parameters
    ----------
    geometry
        An outline or a soup, in model units; images have no other frame than their own.
    frame
        The frame of the grid.

    Examples
    --------
    >>> line = Outline.from_chains([[(0.0, 0.0), (2.0, 1.0)]])
    >>> to_frame(line, Frame(sides=(2.0, 0.5))).points.tolist()
    [[0.0, 0.0], [1.0, 2.0]]
    """
    if frame.is_plain or not isinstance(geometry, (Outline, Soup)):
        return geometry
    if isinstance(geometry, Outline):
        return replace(geometry, points=frame.to_grid(geometry.points))
    if frame not in geometry.remembered:
        placed = replace(geometry, points=frame.to_grid(geometry.points))
        geometry.remembered[frame] = placed
    found: AnyGeometry = geometry.remembered[frame]
    return found


def box_to_frame(
    box: tuple[tuple[float, ...], tuple[float, ...]] | None, frame: Frame
) -> tuple[tuple[float, ...], tuple[float, ...]] | None:
    """Return a box in the coordinates of a grid whose axes are those of the model.

    Parameters
    ----------
    box
        Lowest and highest corner, in model units; None stays None.
    frame
        The frame of the grid, not turned.

    Returns
    -------
    box
        The corners in the coordinates of the grid; None if there is no box.
    """
    if box is None or not frame.sides:
        return box
    low, high = (tuple(x / s for x, s in zip(end, frame.sides, strict=True)) for end in box)
    return low, high
