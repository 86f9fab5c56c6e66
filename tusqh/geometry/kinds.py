"""The kinds of geometry, as types."""

from __future__ import annotations

from tusqh.geometry.image import Image
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup import Soup

#: A boundary, for which a winding number is defined, as opposed to voxels.
Surface = Outline | Soup

#: Everything that can be meshed.
Geometry = Outline | Soup | Image
