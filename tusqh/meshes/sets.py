"""The named sets of facets and points that files have beside their elements.

There is a set for each side of the boundary (`tusqh.meshes.boundary.SIDES`).  A mesh of several
regions also has a set for every two of them, ``a|b``, whose facets belong to elements of a and
face b, and a set of the points where three of them meet, ``a|b|c``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tusqh.grid import IntArray
from tusqh.meshes.boundary import SIDES, describe_side
from tusqh.meshes.interfaces import find_interfaces, find_junctions
from tusqh.meshes.regions import Regions
from tusqh.meshes.volume_mesh import VolumeMesh


class FacetSet(NamedTuple):
    """A named set of facets.

    Parameters
    ----------
    number
        Number of the set in files, from 1.
    name, meaning
        Name of the set, and what is in it.
    corners
        Points of every facet, which faces away from its element, shape (r, 2**(dim - 1)).
    element, local
        Element of every facet, and its number within the element, shape (r,).
    is_repeated
        Whether its facets are in earlier sets too.
    """

    number: int
    name: str
    meaning: str
    corners: IntArray
    element: IntArray
    local: IntArray
    is_repeated: bool


class PointSet(NamedTuple):
    """A named set of points.

    Parameters
    ----------
    number
        Number of the set in files, from 1.
    name
        Name of the set.
    points
        Its points, ascending, shape (r,).
    """

    number: int
    name: str
    points: IntArray


def facet_sets(mesh: VolumeMesh, regions: Regions) -> list[FacetSet]:
    """Return the sides of the boundary and, of several regions, the facets between every two.

    Parameters
    ----------
    mesh
        The mesh.
    regions
        Its regions.
    """
    boundary = mesh.boundary
    sets = []
    for attribute in np.unique(boundary.attribute).tolist():
        rows = boundary.attribute == attribute
        found = (boundary.corners[rows], boundary.element[rows], boundary.local[rows], False)
        name = SIDES[attribute - 1]
        sets.append(FacetSet(attribute, name, describe_side(name), *found))
    if not regions.are_several:
        return sets
    names = regions.file_names
    pairs = find_interfaces(mesh, regions.material, names)
    for number, ((a, b), side) in enumerate(pairs.items(), start=len(SIDES) + 1):
        is_repeated = b == names[-1] or names.index(b) < names.index(a)
        found = (side.facets, side.elements, side.local, is_repeated)
        sets.append(FacetSet(number, f"{a}|{b}", f"facets of {a} that face {b}", *found))
    return sets


def point_sets(mesh: VolumeMesh, regions: Regions) -> list[PointSet]:
    """Return the points at which three regions meet, of which the outside may be one.

    Parameters
    ----------
    mesh
        The mesh.
    regions
        Its regions.
    """
    if not regions.are_several:
        return []
    junctions = find_junctions(mesh, regions.material, regions.file_names)
    return [
        PointSet(number, "|".join(three), points)
        for number, (three, points) in enumerate(junctions.items(), start=1)
    ]
