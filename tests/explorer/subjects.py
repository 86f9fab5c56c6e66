"""Models for the explorer, made from fields by the same steps as in the workflow."""

import numpy as np
import pandas as pd

from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.explorer.command import mesh_command
from tusqh.explorer.subject import Subject
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup import Soup
from tusqh.grid import BackgroundGrid
from tusqh.sampling.doubled_grid import RESOLUTION
from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.goal import Goal
from tusqh.settings.model import Settings
from tusqh.threshold.choose import choose_threshold
from tusqh.threshold.plateaus import Plateaus
from tusqh.topology.persistence import locate_pairs


def noise(rng, shape, n_levels=6):
    """Return independent fractions of cells and sub-cells, which give pinches everywhere."""
    values = rng.integers(0, n_levels, [2 * n + 1 for n in shape]) / (n_levels - 1)
    values[rng.random(values.shape) < 0.02] = -0.25  # Winding numbers can also be outside [0, 1].
    grid = BackgroundGrid(shape=tuple(shape), cell_size=0.5, origin=(10.0, -3.0, 1.0)[: len(shape)])
    return VolumeFractions.from_values(grid, 4, values)


def box_of(grid):
    """Return the boundary of the grid's box, as an outline or a soup."""
    if grid.dim == 2:
        (x0, y0), (x1, y1) = grid.origin, grid.upper
        ring = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]])
        return Outline.from_chains([ring], name="box")
    corners = np.array([grid.origin, grid.upper])
    points = np.stack(np.meshgrid(*corners.T, indexing="ij"), axis=-1).reshape(-1, 3)
    triangles = np.array([[0, 1, 2], [1, 3, 2], [4, 6, 5], [5, 6, 7]])
    return Soup(points, triangles, np.zeros(4, dtype=np.int64), name="box")


def make_subject(fractions, policy=None, *, name="noise", threshold=0.5):
    """Return everything about a field that its explorer shows; a policy may hold a goal instead."""
    settings = Settings.from_dict(policy or {})
    goal = Goal(threshold=threshold) if settings.goal == Goal() else settings.goal
    cell_sets = CellSets(fractions, settings.policy)
    curves = cell_sets.topology.curves
    plateaus = Plateaus(cell_sets)
    selection, _ = choose_threshold(plateaus, goal, name=name)
    built = build_mesh(selection.cells, fractions.grid, name=name)
    verdict = pd.DataFrame(
        [("a_check", "a check", "0", "0", "yes")],
        columns=["id", "name", "found", "required", "holds"],
    )
    return Subject(
        name=name,
        unit="mm",
        up="z",
        command=mesh_command(f"{name}.stl", settings, name=name),
        geometry=box_of(fractions.grid),
        fractions=fractions,
        curves=curves,
        topologies=plateaus.table,
        diagram=locate_pairs(cell_sets.topology.pairs, fractions.grid),
        selection=selection,
        mesh=built.mesh,
        tables={
            "defects": pd.DataFrame(
                {"defect": ["open_ends"], "count": [3], "explanation": ["why"]}
            ),
            "elements": pd.DataFrame({"metric": ["skew"], "mean": [0.25]}),
            "verdict": verdict,
            "features": built.cells.features,
            "bridges": built.cells.bridge_table,
        },
    )


def keys_of(values):
    return np.rint(np.asarray(values) / RESOLUTION).astype(np.int64)
