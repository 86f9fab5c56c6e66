"""The named sets of facets, points and elements that files have beside their elements.

Every boundary facet is in one set of its own: a plane of the box (``x_min``), or a wall: of a hole
(``hole_1``), of a void, of a recess, or another one.  It is in further sets too, which are written
in formats where a facet may be in several: its component of the boundary (``boundary_1``), its
direction (``normal_x_minus``), and the part of the input that is nearest.

Every element is in a block: its connected part (``part_1``) if there is one material, else its
material.  A mesh of several regions also has a set of facets for every two of them, ``a|b``, which
belong to elements of a and face b, and a set of the points where three of them meet, ``a|b|c``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from tusqh.grid import FloatArray, IntArray
from tusqh.grid.components import label_components
from tusqh.meshes.boundary import SIDES, describe_side
from tusqh.meshes.boundary_pieces import groups_of, rounded_places
from tusqh.meshes.interfaces import find_interfaces, find_junctions
from tusqh.meshes.regions import Regions
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.meshes.walls import (
    Division,
    Wall,
    boundary_components,
    divide_boundary,
)

#: Number of sides that lie on planes of the box.
_N_PLANES = 6


class FacetSet(NamedTuple):
    """A named set of facets.

    Parameters
    ----------
    number
        Number of the set in files, from 1.
    name, kind, meaning
        Name of the set, what kind of set it is, and what is in it.
    corners
        Points of every facet, which faces away from its element, shape (r, 2**(dim - 1)).
    element, local
        Element of every facet, and its number within the element, shape (r,).
    is_repeated
        Whether its facets are in earlier sets too.
    """

    number: int
    name: str
    kind: str
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


class ElementSet(NamedTuple):
    """A named set of elements.

    Parameters
    ----------
    number
        Number of the set in files, from 1.
    name, kind, meaning
        Name of the set, what kind of set it is, and what is in it.
    elements
        Its elements, ascending, shape (r,).
    """

    number: int
    name: str
    kind: str
    meaning: str
    elements: IntArray


class Labels(NamedTuple):
    """A further division of the boundary, such as by the parts of the input.

    Parameters
    ----------
    kind, meaning
        What kind of sets these are, and what is in one.
    names
        Their names, in which letters, digits and underscores stay.
    of_facet
        Index into `names` of every boundary facet, -1 for none, shape (b,).
    """

    kind: str
    meaning: str
    names: Sequence[str]
    of_facet: IntArray


@dataclass(frozen=True)
class NamedSets:
    """All named sets of a mesh.

    Parameters
    ----------
    facets
        The sets of facets, those with `is_repeated` last.
    points
        The points at which three regions meet.
    blocks
        Sets of elements; each element is in one.
    groups
        Sets of elements that are in `blocks` too.
    """

    facets: list[FacetSet]
    points: list[PointSet]
    blocks: list[ElementSet]
    groups: list[ElementSet]

    @property
    def once(self) -> list[FacetSet]:
        """The sets of facets of which each facet is in one."""
        return [found for found in self.facets if not found.is_repeated]


def find_sets(
    mesh: VolumeMesh,
    regions: Regions | None = None,
    *,
    is_smooth: bool = False,
    labels: Sequence[Labels] = (),
) -> NamedSets:
    """Return the named sets of a mesh.

    Parameters
    ----------
    mesh
        The mesh.
    regions
        Its regions; None: there is one.
    is_smooth
        Whether the boundary was fitted, so that its sharp edges divide it.
    labels
        Further divisions of the boundary.
    """
    regions = regions or Regions.single(mesh.n_cells)
    division = divide_boundary(mesh, is_smooth=is_smooth)
    facets = _sets_of_division(mesh, division)
    names = regions.file_names
    if regions.are_several:
        for (a, b), side in find_interfaces(mesh, regions.material, names).items():
            is_repeated = b == names[-1] or names.index(b) < names.index(a)
            arrays = side.facets, side.elements, side.local
            meaning = f"facets of {a} that face {b}"
            facets.append(FacetSet(0, f"{a}|{b}", "interface", meaning, *arrays, is_repeated))
    facets += _repeated_sets(mesh, division, labels)
    blocks, groups = _element_sets(mesh, regions)
    return NamedSets(_numbered(facets), _point_sets(mesh, regions), blocks, groups)


def _numbered(facets: list[FacetSet]) -> list[FacetSet]:
    """Return sets of facets with different numbers, of which the planes of the box have 1 to 6."""
    facets = sorted(facets, key=lambda found: found.is_repeated)
    taken, numbered = _N_PLANES, []
    for found in facets:
        if found.number == 0:
            taken += 1
            found = found._replace(number=taken)
        numbered.append(found)
    return numbered


def _of_rows(mesh: VolumeMesh, rows: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    boundary = mesh.boundary
    return boundary.corners[rows], boundary.element[rows], boundary.local[rows]


def _sets_of_division(mesh: VolumeMesh, division: Division) -> list[FacetSet]:
    """Return the planes of the box and the walls."""
    sets = []
    is_wall = np.zeros(len(division.attribute), dtype=np.bool_)
    for wall in division.walls:
        is_wall[wall.rows] = True
    for number, name in enumerate(SIDES[:_N_PLANES], start=1):
        rows = np.flatnonzero((division.attribute == number) & ~is_wall)
        if len(rows):
            arrays = _of_rows(mesh, rows)
            sets.append(FacetSet(number, name, "plane", describe_side(name), *arrays, False))
    count: dict[str, int] = {}
    for wall in division.walls:
        k = count[wall.kind] = count.get(wall.kind, 0) + 1
        arrays = _of_rows(mesh, wall.rows)
        name = f"{wall.kind}_{k}"
        sets.append(FacetSet(0, name, wall.kind, _describe_wall(wall), *arrays, False))
    return sets


def _describe_wall(wall: Wall) -> str:
    meaning = {
        "hole": "wall of a hole",
        "void": "wall of a void",
        "recess": "wall of a recess or of a notch",
        "wall": "connected piece of the rest of the boundary",
    }[wall.kind]
    if wall.n_holes > 1 or (wall.n_holes and wall.kind != "hole"):
        holes = "a hole passes" if wall.n_holes == 1 else f"{wall.n_holes} holes pass"
        meaning += f", along which {holes}"
    return meaning


def _repeated_sets(
    mesh: VolumeMesh, division: Division, labels: Sequence[Labels]
) -> list[FacetSet]:
    """Return the components of the boundary, the directions of walls, and further divisions."""
    component = boundary_components(mesh)
    size = np.bincount(component)
    rank = np.empty(len(size), dtype=np.int64)
    middles = mesh.points[mesh.boundary.corners].mean(axis=1)
    rank[_by_size_and_place(mesh, component, middles)] = np.arange(len(size))
    numbered = [f"boundary_{k + 1}" for k in range(len(size))]
    all_labels = [
        Labels("boundary", "connected component of the boundary", numbered, rank[component]),
        *labels,
    ]
    sets = []
    for found in all_labels:
        names = Regions(tuple(found.names), found.of_facet).file_names
        for rows in groups_of(found.of_facet, np.flatnonzero(found.of_facet >= 0)):
            name = names[int(found.of_facet[rows[0]])]
            arrays = _of_rows(mesh, rows)
            sets.append(FacetSet(0, name, found.kind, found.meaning, *arrays, True))
    for number in range(_N_PLANES + 1, len(SIDES) + 1):
        rows = np.flatnonzero(division.attribute == number)
        if len(rows):
            name = SIDES[number - 1]
            arrays = _of_rows(mesh, rows)
            sets.append(FacetSet(0, name, "direction", describe_side(name), *arrays, True))
    return sets


def _element_sets(mesh: VolumeMesh, regions: Regions) -> tuple[list[ElementSet], list[ElementSet]]:
    """Return the blocks of elements, and the sets that are in them too."""
    part = _parts(mesh, regions)
    blocks, groups = [], []
    for region in regions.present:
        name, meaning = region.name, f"elements of {region.name}"
        whole = ElementSet(region.number, name, "region", meaning, region.elements)
        _, own, size = np.unique(part[region.elements], return_inverse=True, return_counts=True)
        order = np.zeros(1, dtype=np.int64)
        if len(size) > 1:
            middles = mesh.points[mesh.cells[region.elements]].mean(axis=1)
            order = _by_size_and_place(mesh, own, middles)
        rank = np.empty(len(size), dtype=np.int64)
        rank[order] = np.arange(len(size))
        by_rank = region.elements[np.argsort(rank[own], kind="stable")]
        pieces = np.split(by_rank, np.cumsum(size[order])[:-1])
        stem = f"{name}_part" if regions.are_several else "part"
        parts = [
            ElementSet(k, f"{stem}_{k}", "part", f"connected part of {name}", piece)
            for k, piece in enumerate(pieces, start=1)
        ]
        if len(parts) == 1:
            blocks.append(whole)
        elif regions.are_several:
            blocks.append(whole)
            groups += parts
        else:
            blocks += parts
            groups.append(whole)
    first = max(block.number for block in blocks) + 1
    return blocks, [g._replace(number=k) for k, g in enumerate(groups, start=first)]


def _by_size_and_place(mesh: VolumeMesh, label: IntArray, middles: FloatArray) -> IntArray:
    """Return labels from the largest to the smallest; the place decides between equal ones."""
    places = rounded_places(mesh.points, middles)
    order = np.lexsort([*places.T[::-1], label])
    first = order[np.unique(label[order], return_index=True)[1]]
    return np.asarray(np.lexsort([*places[first].T[::-1], -np.bincount(label)]))


def _parts(mesh: VolumeMesh, regions: Regions) -> IntArray:
    """Return the connected part of every element; parts share facets and a region."""
    facets = mesh.facets
    order = np.argsort(facets.unique, kind="stable")
    same = np.flatnonzero(facets.unique[order][1:] == facets.unique[order][:-1])
    one, other = facets.cell[order[same]], facets.cell[order[same + 1]]
    is_inner = regions.material[one] == regions.material[other]
    return label_components(one[is_inner], other[is_inner], mesh.n_cells)[0]


def _point_sets(mesh: VolumeMesh, regions: Regions) -> list[PointSet]:
    """Return the points at which three regions meet, of which the outside may be one."""
    if not regions.are_several:
        return []
    junctions = find_junctions(mesh, regions.material, regions.file_names)
    return [
        PointSet(number, "|".join(three), points)
        for number, (three, points) in enumerate(junctions.items(), start=1)
    ]
