"""Measure overlaps, gaps and interfaces of every two materials."""

from __future__ import annotations

import numba
import numpy as np
import pandas as pd

from tusqh.contacts.material_fractions import MaterialFractions
from tusqh.contacts.mesh import MaterialMesh
from tusqh.grid import FloatArray, IntArray, doubled
from tusqh.meshes.interfaces import facet_areas
from tusqh.sampling.doubled_grid import RESOLUTION

#: Columns of `tabulate_pairs`.
PAIR_COLUMNS = ["first", "second", "overlap", "gap", "facets", "area"]


def tabulate_pairs(
    found: MaterialMesh, fractions: MaterialFractions, overlaps: FloatArray | None = None
) -> pd.DataFrame:
    """Return overlap, gap and interface of every two materials that have any of these.

    There is one row per pair, sorted by the numbers of `first` and `second`: `overlap`, the volume
    (2D: area) that both claim and the first one takes; `gap`, the volume of void in cells that have
    fractions of both, where they are the two largest; `facets` and `area` of the interface in the
    mesh.  Volumes and areas are in model units.

    Parameters
    ----------
    found
        The mesh.
    fractions
        The fractions of which it was made.
    overlaps
        Volumes of overlaps, shape (m, m); None: there are none.
    """
    names, void = found.names, len(found.names) - 1
    rows: dict[tuple[int, int], dict[str, float]] = {}
    if overlaps is not None:
        for i, j in np.argwhere(overlaps > 0).tolist():
            rows.setdefault((i, j), {})["overlap"] = float(overlaps[i, j])
    pairs, volumes = find_gaps(fractions)
    for (i, j), volume in zip(pairs.tolist(), volumes.tolist(), strict=True):
        rows.setdefault((i, j), {})["gap"] = volume
    for (a, b), interface in found.interfaces.items():
        i, j = names.index(a), names.index(b)
        if i < j < void:
            row = rows.setdefault((i, j), {})
            row["facets"] = len(interface.facets)
            row["area"] = float(facet_areas(found.mesh.points, interface.facets).sum())
    table = pd.DataFrame(
        [{"first": names[i], "second": names[j], **rows[i, j]} for i, j in sorted(rows)],
        columns=PAIR_COLUMNS,
    ).fillna(0.0)
    return table.astype({"facets": np.int64})


def find_gaps(fractions: MaterialFractions) -> tuple[IntArray, FloatArray]:
    """Return the pairs of materials with thin gaps between them, and the volumes of the gaps.

    A cell belongs to the gap of two materials if it has fractions of both, and of void.  If it has
    fractions of more, it belongs to the two largest.

    Parameters
    ----------
    fractions
        The fractions.

    Returns
    -------
    pairs
        Materials, the lower number first, shape (r, 2).
    volumes
        Volume (2D: area) of void in these cells, in model units, shape (r,).

    Examples
    --------
    >>> from tusqh.grid import BackgroundGrid
    >>> two = [np.full((3, 3), 2**18), np.full((3, 3), 2**19)]
    >>> grid = BackgroundGrid((1, 1), 1.0, (0.0, 0.0))
    >>> pairs, volumes = find_gaps(MaterialFractions.from_multiples(grid, ["a", "b"], two))
    >>> pairs.tolist(), volumes.tolist()
    ([[0, 1]], [0.25])
    """
    grid = fractions.grid
    shape = tuple(2 * n + 1 for n in grid.shape)
    places = np.arange(np.prod(shape)).reshape(shape)[doubled.cells(grid.dim)].ravel()
    entries = (fractions.start, fractions.material, fractions.multiple)
    found = _find_gaps(places, entries, fractions.void)
    found = found[found[:, 2] > 0]
    keys, number = np.unique(found[:, 0] * len(fractions.names) + found[:, 1], return_inverse=True)
    pairs = np.stack(np.divmod(keys, len(fractions.names)), axis=1)
    voids = np.bincount(number, weights=found[:, 2], minlength=len(keys))
    volumes = voids.astype(np.float64) * RESOLUTION * grid.cell_size**grid.dim
    return pairs, volumes


@numba.njit(cache=True)
def _find_gaps(places, entries, void):  # type: ignore[no-untyped-def]
    """Return for every cell its two largest materials and its multiple of void if it is a gap."""
    start, material, multiple = entries
    found = np.zeros((len(places), 3), dtype=np.int64)
    for i in range(len(places)):
        first = second = -1
        f = g = h = 0
        for at in range(start[places[i]], start[places[i] + 1]):
            if material[at] == void:
                h = multiple[at]
            elif multiple[at] > f:
                second, g = first, f
                first, f = material[at], multiple[at]
            elif multiple[at] > g:
                second, g = material[at], multiple[at]
        if second >= 0 and h > 0:
            found[i, 0], found[i, 1], found[i, 2] = min(first, second), max(first, second), h
    return found
