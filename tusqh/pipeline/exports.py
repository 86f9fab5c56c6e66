"""How the mesh of a geometry is exported: its sets by the input, and its middle nodes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tusqh.geometry.kinds import Geometry
from tusqh.geometry.soup import Soup
from tusqh.grid import IntArray
from tusqh.meshes.choose_sets import Wish
from tusqh.meshes.elements import Element
from tusqh.meshes.formats import Export
from tusqh.meshes.patches import labels_of_patches
from tusqh.meshes.sets import Labels
from tusqh.meshes.volume_mesh import VolumeMesh


def export_of(
    mesh: VolumeMesh,
    geometry: Geometry | None = None,
    *,
    is_fitted: bool = False,
    patch: IntArray | None = None,
    element: str | None = None,
    layer: float | None = None,
    sets: Sequence[str] = (),
) -> Export:
    """Return how a mesh is written.

    Parameters
    ----------
    mesh
        The mesh.
    geometry
        Its geometry; None: the boundary is not divided by it.
    is_fitted
        Whether its boundary was moved onto the geometry.
    patch
        Smooth patch of every boundary facet of a fitted mesh, see `tusqh.fitting.fitted.Fitted`;
        None: it has none.
    element
        Kind of the elements, see `tusqh.meshes.elements.ELEMENTS`; None: linear.
    layer
        Thickness of the one layer of hexes that a mesh of quads becomes; None: it stays plane.
    sets
        Names for sets by a place, such as ``"bolt=near:30,20,0"``.

    Raises
    ------
    ConfigError
        The element does not exist or does not fit the mesh, or a text names no place.
    """
    dim = 3 if layer is not None else mesh.dim
    is_quadratic, mover = Element.of(element, dim).is_quadratic, None
    if geometry and is_fitted and is_quadratic:
        from tusqh.fitting.midpoints import mover_onto

        mover = mover_onto(geometry)
    return Export(
        element=element,
        layer=layer,
        wishes=tuple(Wish.read(text) for text in sets),
        is_smooth=is_fitted,
        labels=(
            *labels_of_patches(mesh, patch),
            *(() if geometry is None else labels_of_input(mesh, geometry)),
        ),
        mover=mover,
    )


def labels_of_input(mesh: VolumeMesh, geometry: Geometry) -> tuple[Labels, ...]:
    """Return the division of the boundary by the nearest part of the input, if it has several.

    Parameters
    ----------
    mesh
        The mesh.
    geometry
        Its geometry; only soups have parts here.

    Returns
    -------
    tuple of Labels
        One division, or none.
    """
    if not isinstance(geometry, Soup) or int(geometry.parts.max()) == 0:
        return ()
    from tusqh.sampling.nearest_triangle import find_nearest, make_tree

    n = int(geometry.parts.max()) + 1
    given = geometry.part_names or n * ("",)
    names = [f"input_{name or k}" for k, name in enumerate(given, start=1)]
    centres = mesh.points[mesh.boundary.corners].mean(axis=1)
    found = find_nearest(make_tree(geometry.points[geometry.triangles]), centres)
    of_facet = geometry.parts[found.triangle].astype(np.int64)
    return (Labels("input", "facets nearest to this part of the input", names, of_facet),)
