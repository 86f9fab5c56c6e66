"""Mesh gaps, and compare the meshes with the filtration by gap width.

In the plane every pinch follows its vote, so the mesh differs from the filtration only in bridges,
which join components that interior edges connect.  With exact areas:

* the vertex of a pinch across a gap lies midway between two dropped cells, where the gap is at
  least as wide; so it is exterior, and all pinches of a gap are separated;
* an edge between two dropped cells is exterior for the same reason, so no path of edges crosses the
  gap;
* but a pinch whose vertex is exterior may have two interior edges beside one of its empty cells,
  one on either side of the gap; if nothing else joins the two sides, they make a bridge.  This
  requires a gap that drops cells up to a quarter of a cell's diagonal extent from its middle, and
  such a gap is within the window anyway, because a longer patch of it is joined somewhere.
"""

from __future__ import annotations

import numpy as np
import pandas as pd

from studies.directions import normals_of
from studies.gap import sample_distances
from studies.gap_kernels import RULES, fraction_in_gap
from studies.gap_patch import measure_widths
from studies.theorem import crossing_widths, method_name
from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.grid import BackgroundGrid, FloatArray
from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.policy import Policy

_ROWS = 7

#: Most trials are this close to a width at which the outcome changes.
_CLOSE = 0.01


def gap_fractions(
    normal: FloatArray, offset: float, width: float, shape: tuple[int, ...], samples: int
) -> VolumeFractions:
    """Return the fractions of cells along a gap; the material extends beyond the grid.

    Parameters
    ----------
    normal
        Unit normal, shape (dim,), components not negative.
    offset
        Shift of the grid along its first axis.  At 0, in the first layer of cells along the other
        axes, the cell halfway along the first axis is centred on the middle of the gap.
    width
        Width of the gap, in cell sizes.
    shape
        Cells of the grid.
    samples
        Samples along the side of a cell; 0 for exact fractions.
    """
    grid = BackgroundGrid(shape=shape, cell_size=1.0, origin=(0.0,) * len(shape))
    places = np.indices(tuple(2 * n + 1 for n in shape)) / 2 - 0.5
    places[0] += offset - shape[0] // 2
    u = np.tensordot(normal, places, axes=1)
    if samples:
        distances = sample_distances(normal, samples)
        filled = np.abs(u[..., None] + distances) >= width / 2
        values = filled.mean(axis=-1)
    else:
        flat = [1 - fraction_in_gap(float(x), width, normal) for x in u.ravel()]
        values = np.array(flat).reshape(u.shape)
    return VolumeFractions.from_values(grid, samples, values)


def compare_with_meshes(n_trials: int, samples: int, rng: np.random.Generator) -> pd.DataFrame:
    """Return random gaps, and whether the filtration and the mesh join their two sides.

    `bare` is the mesh without bridges; `in_window` states that a gap of that width and rotation can
    be joined, with exact fractions, at some offset.

    Parameters
    ----------
    n_trials
        Number of gaps; two thirds of them are close to a width at which some rule opens.
    samples
        Samples along the side of a cell; 0 for exact fractions.
    rng
        Source of the random rotations, offsets and widths.
    """
    rows = []
    for _ in range(n_trials):
        degrees, offset = float(rng.uniform(0.5, 44.5)), float(rng.uniform(0.0, 1.0))
        normal = normals_of(np.array([[degrees]]))[0]
        distances = sample_distances(normal, samples)[None]
        _, opening = measure_widths(normal[None], np.array([offset]), distances, length=_ROWS)
        width = float(rng.uniform(0.3, 1.5))
        if rng.uniform() < 2 / 3:
            width = float(rng.choice(opening[0, 0])) + _CLOSE * float(rng.choice([-1.0, 1.0]))
        shape = (2 * _ROWS + 7, _ROWS)
        fractions = gap_fractions(normal, offset, width, shape, samples)
        bare = CellSets(fractions, Policy(bridges="none")).at(0.5)
        resolved = build_mesh(CellSets(fractions).at(0.5), fractions.grid)
        crossing = crossing_widths("filtration", normal[None])[0]
        rows.append(
            {
                "method": method_name(samples),
                "degrees": round(degrees, 4),
                "offset": round(offset, 4),
                "width": round(width, 6),
                "filtration_joins": width <= opening[0, 0, RULES.index("filtration")],
                "bare_mesh_joins": bare.predicted.betti_0 == 1,
                "mesh_joins": resolved.mesh.measurement.by_euler.betti_0 == 1,
                "overruled": bare.n_overruled,
                "bridges": resolved.cells.n_bridges,
                "in_window": width <= crossing,
            }
        )
    table = pd.DataFrame(rows)
    table["bare_agrees"] = table["bare_mesh_joins"] == table["filtration_joins"]
    table["agrees"] = table["mesh_joins"] == table["filtration_joins"]
    return table
