"""Tell which axis points up in pictures of a solid."""

from __future__ import annotations

from typing import Literal

#: An axis of the coordinates.
Axis = Literal["x", "y", "z"]

#: Suffixes of formats whose convention is that y points up.
_Y_UP = (".obj", ".glb", ".gltf")


def upright_axis(geometry: str, chosen: Axis | None = None) -> Axis:
    """Return the axis that points up: the chosen one, or that of the format's convention.

    Parameters
    ----------
    geometry
        Name of the geometry file, or its path.
    chosen
        The axis that the user asked for, if any.

    Examples
    --------
    >>> upright_axis("bunny.OBJ"), upright_axis("part.stl"), upright_axis("part.stl", "x")
    ('y', 'z', 'x')
    """
    return chosen or ("y" if geometry.lower().endswith(_Y_UP) else "z")
