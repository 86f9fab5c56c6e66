"""Make the arrays that the page draws: field, plateaus, diagram, mesh and geometry.

The page needs no list of faces for each threshold.  A face between two cells is on the boundary of
the kept cells exactly for ``lower fraction < t <= higher fraction``, so the ranks of the cell
fractions determine this for every threshold; the page lists the faces once and picks the visible
ones at each step.

Fractions and thresholds are *keys*, integer multiples of `RESOLUTION` in 0..`FULL`; coordinates are
in cells from the grid's origin.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from tusqh.antialias.cells import CellSets
from tusqh.explorer.distances import as_colours
from tusqh.explorer.encode import smallest_unsigned
from tusqh.geometry.image import Image
from tusqh.geometry.kinds import Geometry
from tusqh.geometry.outline import Outline
from tusqh.grid import BackgroundGrid, FloatArray, IntArray
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.sampling.doubled_grid import RESOLUTION
from tusqh.sampling.fractions import VolumeFractions
from tusqh.threshold.plateaus import BETTI
from tusqh.topology.clamping import FULL

Arrays = dict[str, NDArray[Any]]

#: Of a mesh with more elements only the boundary is shown, so it cannot be cut open.
CUT_ELEMENTS = 200_000

#: A geometry with more segments or triangles is omitted.
GEOMETRY_PIECES = 300_000

#: Steps of a coordinate along the longest side of the geometry's box.
_GEOMETRY_STEPS = 2**16 - 1


def field_arrays(fractions: VolumeFractions) -> Arrays:
    """Return the cell fractions: `levels` (ascending distinct keys) and the `rank` of each cell.

    A cell of rank r is kept at thresholds up to ``levels[r]``; cells of rank 0 are never kept.

    Parameters
    ----------
    fractions
        Volume fractions of cells and sub-cells.

    Examples
    --------
    >>> values = np.zeros((5, 3))
    >>> values[1::2, 1] = 0.75, -0.125
    >>> grid = BackgroundGrid(shape=(2, 1), cell_size=1.0, origin=(0.0, 0.0))
    >>> arrays = field_arrays(VolumeFractions.from_values(grid, 4, values))
    >>> (arrays["levels"] / FULL).tolist(), arrays["rank"].tolist()
    ([0.0, 0.75], [1, 0])
    """
    keys = np.clip(_to_keys(fractions.cells), 0, FULL).ravel()
    levels, rank = np.unique(np.append(keys, 0), return_inverse=True)
    return {"levels": levels.astype(np.uint32), "rank": smallest_unsigned(rank[:-1])}


def plateau_arrays(cell_sets: CellSets, curves: pd.DataFrame, topologies: pd.DataFrame) -> Arrays:
    """Return the plateaus of the threshold, from high to low, with Betti numbers and changes.

    Parameters
    ----------
    cell_sets
        The cells of every threshold.
    curves
        Raw Betti numbers, see `tusqh.topology.topology.Topology.curves`.
    topologies
        Betti numbers of meshes, see `tusqh.threshold.plateaus.Plateaus.table`.

    Returns
    -------
    arrays
        `upper`: key of every plateau's highest threshold; its lower end is the `upper` of the next
        plateau, or 0 for the last one.  ``raw_0`` .. ``raw_2``: Betti numbers of the filtration.
        ``mesh_0`` .. ``mesh_2``: Betti numbers of the mesh, -1 if they were not predicted;
        `contacts` and `bridges` there.  `toggles`: flat indices of cells that begin or
        cease to be removed or filled against their fraction; those of plateau p start at
        ``toggles_from[p]``.
    """
    ends = [table[end] for table in (curves, topologies) for end in ("upper", "lower")]
    keys = np.unique(_to_keys(np.concatenate(ends)))
    upper = keys[(keys > 0) & (keys <= FULL)][::-1]
    arrays = {"upper": upper.astype(np.uint32)}
    of_curve = _row_of(curves, upper)
    for k, name in enumerate(BETTI):
        arrays[f"raw_{k}"] = curves[name].to_numpy()[of_curve].astype(np.int32)
    of_mesh = _row_of(topologies, upper)
    ends_of = [_to_keys(topologies[end].to_numpy())[of_mesh] for end in ("lower", "upper")]
    is_examined = (ends_of[0] < upper) & (upper <= ends_of[1])
    columns = {"contacts": "contacts", "bridges": "bridges"}
    for key, name in (columns | {f"mesh_{k}": name for k, name in enumerate(BETTI)}).items():
        found = topologies[name].to_numpy()[of_mesh]
        arrays[key] = np.where(is_examined, found, -1).astype(np.int32)
    return arrays | _toggles(cell_sets, topologies, np.where(is_examined, of_mesh, -1))


def _toggles(cell_sets: CellSets, topologies: pd.DataFrame, of_mesh: IntArray) -> Arrays:
    """Return the cells that begin or cease to follow their fraction at each plateau."""
    cells = cell_sets.fractions.cells
    thresholds = topologies["threshold"].to_numpy()
    is_special = np.asarray((topologies["removed"] > 0) | (topologies["filled"] > 0))
    before = nothing = np.empty(0, dtype=np.int64)
    known = {-1: nothing}
    changes = []
    for row in of_mesh.tolist():
        if row not in known:
            known = {-1: nothing, row: nothing}
            if is_special[row]:
                kept = cell_sets.at(thresholds[row]).kept
                known[row] = np.flatnonzero(kept != (cells >= thresholds[row]))
        changes.append(np.setxor1d(before, known[row], assume_unique=True))
        before = known[row]
    starts = np.cumsum([0, *map(len, changes)])
    return {
        "toggles_from": starts.astype(np.uint32),
        "toggles": np.concatenate([nothing, *changes]).astype(np.uint32),
    }


def order_pairs(pairs: pd.DataFrame) -> IntArray:
    """Return the rows of the persistence pairs in the order of the page, longest-lived first.

    Parameters
    ----------
    pairs
        See `pair_arrays`.
    """
    columns = -pairs["birth"], pairs["dimension"], -pairs["persistence"]
    return np.lexsort([column.to_numpy(dtype=float) for column in columns])


def pair_arrays(pairs: pd.DataFrame, grid: BackgroundGrid) -> Arrays:
    """Return the persistence pairs, sorted by decreasing persistence.

    Parameters
    ----------
    pairs
        See `tusqh.topology.persistence.locate_pairs`.
    grid
        The grid to which they belong.

    Returns
    -------
    arrays
        `dimension`, `birth` and `death` (keys), and the places that create and destroy each
        class as flat indices into the doubled grid, -1 if nothing destroys it.
    """
    pairs = pairs.iloc[order_pairs(pairs)]
    arrays: Arrays = {"dimension": pairs["dimension"].to_numpy().astype(np.uint8)}
    shape = tuple(2 * n + 1 for n in grid.shape)
    for event in ("birth", "death"):
        arrays[event] = _to_keys(pairs[event].to_numpy()).astype(np.uint32)
        at = pairs[[f"{event}_{axis}" for axis in "xyz"[: grid.dim]]].to_numpy(dtype=float)
        is_there = np.isfinite(at).all(axis=1)
        doubled = np.rint(2 * _in_cells(np.where(is_there[:, None], at, grid.origin), grid))
        place = np.ravel_multi_index(tuple(doubled.astype(np.int64).T), shape)
        arrays[f"{event}_place"] = np.where(is_there, place, -1).astype(np.int32)
    return arrays


def mesh_arrays(
    mesh: VolumeMesh,
    grid: BackgroundGrid,
    material: IntArray | None = None,
    distances: FloatArray | None = None,
) -> Arrays:
    """Return a mesh as facets between elements, so that the page can cut it open.

    Parameters
    ----------
    mesh
        The mesh.
    grid
        The background grid on which it was made.
    material
        Material of every element, shape (m,); None: there is one.
    distances
        Distance of every boundary facet from the geometry, see
        `tusqh.explorer.distances.boundary_distances`; None: it is not shown.

    Returns
    -------
    arrays
        `points`; `corners` of every facet (in 2D of every element), ordered so that it faces out
        of its first element; the first corner is stored as the difference from that of the
        previous facet, the others as differences from the first.  `first`: the first element, as
        the difference from that of the previous facet; `second`: the other element minus the
        first, 0 if there is none.  For every element its `kind`, the grid `cell` in which it lies
        (as the difference from that of the previous element), and its smallest scaled Jacobian as
        `quality`, 0..255; with several materials also its `material`.  `distance` of every facet
        (in 2D of every element, the largest of its sides), see
        `tusqh.explorer.distances.as_colours`.
    """
    n = mesh.n_cells
    points = _in_cells(mesh.points, grid)
    if mesh.dim == 2:
        corners, first, second = mesh.cells, np.arange(n), np.arange(n)
        at, n_rows = mesh.boundary.element, n
    else:
        facets = mesh.facets
        ordered = np.argsort(facets.unique, kind="stable")
        starts = np.cumsum(facets.n_cells_of) - facets.n_cells_of
        row = ordered[starts]
        is_inner = facets.n_cells_of == 2
        partner = ordered[np.minimum(starts + 1, len(ordered) - 1)]
        first, second = facets.cell[row], facets.cell[np.where(is_inner, partner, ordered[starts])]
        corners = facets.corners[row]
        shown = np.argsort(row)
        if n > CUT_ELEMENTS:
            is_hidden = is_inner
            if material is not None:
                is_hidden = is_inner & (material[first] == material[second])
            shown = np.setdiff1d(shown, np.flatnonzero(is_hidden))
        corners, first, second = corners[shown], first[shown], second[shown]
        place = np.full(len(ordered), -1, dtype=np.int64)
        place[row[shown]] = np.arange(len(shown))
        at, n_rows = place[facets.on_boundary], len(shown)
    quality = mesh.jacobians.scaled
    arrays = {
        "points": points.astype(np.float32),
        "corners": np.column_stack([_steps(corners[:, 0]), corners[:, 1:] - corners[:, :1]]),
        "first": _steps(first),
        "second": second - first,
        "kind": mesh.kind.astype(np.uint8),
        "cell": _steps(np.maximum(mesh.grid_cell, 0)),
        "quality": np.rint(255 * np.clip(quality, 0, 1)).astype(np.uint8),
    }
    if distances is not None:
        of_rows = np.full(n_rows, np.nan)
        np.fmax.at(of_rows, at, distances)
        arrays["distance"] = as_colours(of_rows)
    if material is not None:
        arrays["material"] = smallest_unsigned(material)
    # Neighbours on a grid have similar numbers, so differences compress five times better.
    return {name: a.astype(np.int32) if a.dtype == np.int64 else a for name, a in arrays.items()}


def geometry_arrays(geometry: Geometry, grid: BackgroundGrid) -> Arrays:
    """Return the unrepaired geometry: `points`, and `pieces` with the ends or corners of each.

    Points are rounded to 2^16 steps along the longest side of the geometry's box; `box` holds the
    lowest corner and the length of that side.  Images and geometries with too many pieces have no
    pieces.

    Parameters
    ----------
    geometry
        An outline, soup or image.
    grid
        The background grid; coordinates are in its cells.
    """
    if isinstance(geometry, Image):
        points, pieces = np.zeros((1, grid.dim)), np.empty((0, grid.dim), dtype=np.int64)
    elif isinstance(geometry, Outline):
        points, pieces = _in_cells(geometry.points, grid), geometry.segments
    else:
        points, pieces = _in_cells(geometry.points, grid), geometry.triangles
    if len(pieces) > GEOMETRY_PIECES:
        pieces = pieces[:0]
    lower, side = points.min(axis=0), float(np.ptp(points, axis=0).max()) or 1.0
    steps, index = np.unique(
        np.rint((points - lower) / side * _GEOMETRY_STEPS), axis=0, return_inverse=True
    )
    return {
        "box": np.array([*lower, side], dtype=np.float32),
        "points": steps.astype(np.uint16),
        "pieces": smallest_unsigned(index.ravel()[pieces]),
    }


def _steps(numbers: IntArray) -> IntArray:
    return np.diff(numbers, prepend=0)


def _to_keys(values: Any) -> IntArray:
    return np.rint(np.asarray(values, dtype=float) / RESOLUTION).astype(np.int64)


def _row_of(table: pd.DataFrame, upper: IntArray) -> IntArray:
    """Return the row, in a table of plateaus from high to low, that holds each threshold."""
    lower = _to_keys(table["lower"].to_numpy())
    rows = np.searchsorted(-lower, -upper, side="right")
    return np.minimum(rows, len(table) - 1).astype(np.int64)


def _in_cells(points: FloatArray, grid: BackgroundGrid) -> FloatArray:
    return grid.to_lattice(points)
