"""The smooth patches into which the boundary of a fitted mesh falls, as a table and named sets."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from tusqh.errors import MeshError
from tusqh.grid import IntArray
from tusqh.meshes.boundary_pieces import groups_of, lowest_place, rounded_places
from tusqh.meshes.interfaces import facet_areas
from tusqh.meshes.sets import Labels
from tusqh.meshes.volume_mesh import VolumeMesh

#: Columns of the table: element, number of the facet within the element, and patch from 1.
COLUMNS = ("element", "facet", "patch")


def number_patches(mesh: VolumeMesh, patch: IntArray) -> IntArray:
    """Return patches with numbers from the largest to the smallest, -1 for none, shape (b,).

    Parameters
    ----------
    mesh
        The mesh.
    patch
        Patch of every boundary facet in any numbers, -1 for none, shape (b,).
    """
    corners = mesh.boundary.corners
    areas = facet_areas(mesh.points, corners)
    places = rounded_places(mesh.points, mesh.points[corners].mean(axis=1))
    digits = 9 - int(np.floor(np.log10(max(float(areas.sum()), 1e-300))))
    groups = groups_of(patch, np.flatnonzero(patch >= 0))

    def key(rows: IntArray) -> tuple[float, tuple[int, ...]]:
        return -round(float(areas[rows].sum()), digits), lowest_place(places[rows])

    numbered = np.full(len(patch), -1, dtype=np.int64)
    for number, rows in enumerate(sorted(groups, key=key)):
        numbered[rows] = number
    return numbered


def labels_of_patches(mesh: VolumeMesh, patch: IntArray | None) -> tuple[Labels, ...]:
    """Return the division of the boundary into ``patch_1``, ``patch_2``, ...

    Parameters
    ----------
    mesh
        The mesh.
    patch
        Patch of every boundary facet, -1 for none, shape (b,); None: there are no patches.

    Returns
    -------
    tuple of Labels
        One division, or none.
    """
    if patch is None or not (patch >= 0).any():
        return ()
    numbered = number_patches(mesh, patch)
    names = [f"patch_{k + 1}" for k in range(int(numbered.max()) + 1)]
    return (Labels("patch", "facets on one smooth patch of the geometry", names, numbered),)


def table_of_patches(mesh: VolumeMesh, patch: IntArray | None) -> pd.DataFrame:
    """Return the patch of every boundary facet that has one, with the columns `COLUMNS`.

    Parameters
    ----------
    mesh, patch
        See `labels_of_patches`.
    """
    if patch is None:
        return pd.DataFrame(np.zeros((0, 3), dtype=np.int64), columns=list(COLUMNS))
    rows = np.flatnonzero(patch >= 0)
    boundary, numbered = mesh.boundary, number_patches(mesh, patch)
    found = np.stack([boundary.element[rows], boundary.local[rows], numbered[rows] + 1], axis=1)
    return pd.DataFrame(found, columns=list(COLUMNS))


def read_patches(path: Path, mesh: VolumeMesh) -> IntArray:
    """Return the patch of every boundary facet of a mesh from a table, -1 for none, shape (b,).

    Parameters
    ----------
    path
        A file with the columns `COLUMNS`.
    mesh
        The mesh.

    Raises
    ------
    MeshError
        The table is not one of this mesh.
    """
    n_local = 2 * mesh.dim
    where = mesh.boundary.element * n_local + mesh.boundary.local
    patch = np.full(len(where), -1, dtype=np.int64)
    try:
        element, facet, number = pd.read_csv(path)[list(COLUMNS)].to_numpy(dtype=np.int64).T
        wanted = element * n_local + facet
        rows = np.searchsorted(where, wanted)
        if (rows == len(where)).any() or (where[rows] != wanted).any() or (number < 1).any():
            raise ValueError("a facet is not on the boundary of the mesh, or a patch is below 1")
    except (OSError, KeyError, ValueError) as reason:
        raise MeshError(
            f"is not a table of the patches of this mesh: {reason}",
            where=str(path),
            expected=f"the columns {', '.join(COLUMNS)}, with boundary facets of {mesh.name}",
            remedy="make the mesh again",
        ) from reason
    patch[rows] = number - 1
    return patch
