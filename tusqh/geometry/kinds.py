"""The kinds of geometry, as types."""

from __future__ import annotations

from typing import Literal

from tusqh.geometry.image import Image
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup import Soup

#: A boundary, for which a winding number is defined, as opposed to voxels.
Surface = Outline | Soup

#: Everything that can be meshed.
Geometry = Outline | Soup | Image

#: The names of the kinds: outlines and pictures are in the plane, surfaces and images in space.
Kind = Literal["outline", "surface", "image", "picture"]


def kind_of(geometry: Geometry) -> Kind:
    """Return the name of the kind of a geometry.

    Parameters
    ----------
    geometry
        The geometry.

    Examples
    --------
    >>> import numpy as np
    >>> kind_of(Image(np.ones((2, 3)))), kind_of(Image(np.ones((2, 3, 4))))
    ('picture', 'image')
    """
    if isinstance(geometry, Image):
        return "picture" if geometry.dim == 2 else "image"
    return "outline" if isinstance(geometry, Outline) else "surface"
