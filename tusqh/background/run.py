"""Mesh a geometry on a background, from sampling to a measured mesh."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from tusqh.background.background_mesh import BackgroundMesh
from tusqh.background.cells import BackgroundCells, BackgroundCellSets
from tusqh.background.fractions import BackgroundFractions, sample_background
from tusqh.background.improve import improve
from tusqh.background.mesh import build_mesh
from tusqh.errors import ConfigError, MeshError, TopologyError
from tusqh.geometry.kinds import Geometry
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.progress import Progress, log_progress
from tusqh.sampling.doubled_grid import RESOLUTION
from tusqh.settings.goal import Goal
from tusqh.settings.sampling import Sampling
from tusqh.threshold.candidates import rank_candidates
from tusqh.threshold.goals import matches
from tusqh.threshold.plateaus import list_reachable

#: Most candidates that are meshed.
_TRIALS = 10


@dataclass(frozen=True)
class BackgroundResult:
    """A mesh on a background, with what it was made of.

    Parameters
    ----------
    mesh
        The mesh; it is sound, and two counts of its Betti numbers equal `cells.predicted`.
    threshold
        The chosen threshold.
    cells
        The kept cells and the decisions of their pinches.
    fractions
        The volume fractions of the background.
    plateaus
        The topology at every threshold, see `tabulate`.
    """

    mesh: VolumeMesh
    threshold: float
    cells: BackgroundCells
    fractions: BackgroundFractions
    plateaus: pd.DataFrame


def mesh_on_background(
    geometry: Geometry,
    background: BackgroundMesh,
    *,
    goal: Goal | None = None,
    sampling: Sampling | None = None,
    progress: Progress = log_progress,
) -> BackgroundResult:
    """Return the mesh of a geometry on a background.

    Parameters
    ----------
    geometry
        An outline or a soup.
    background
        The background.
    goal
        How the threshold is chosen: `threshold`, `target`, or `volume`, alone or with `target`;
        None: 1/2.  All cells are those of one threshold.
    sampling
        How the geometry is sampled; None: with the defaults.
    progress
        Shows the progress.

    Raises
    ------
    ConfigError
        The goal or the sampling asks for what is not available with a background.
    TopologyError
        No threshold gives the Betti numbers.
    MeshError
        The mesh at the threshold is not sound.

    Examples
    --------
    >>> from tusqh.background.makers import make_cylinder
    >>> from tusqh.geometry.outline import Outline
    >>> square = Outline.from_chains([np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])])
    >>> result = mesh_on_background(square, make_cylinder((0.5, 0.5), 0.9))
    >>> str(result.mesh.measurement.by_euler)
    '(1, 0, 0)'
    """
    goal = goal or Goal()
    require_goal(goal)
    fractions = sample_background(geometry, background, sampling=sampling, progress=progress)
    sets = BackgroundCellSets(background, fractions.values)
    plateaus = tabulate(sets, fractions)
    failed = ""
    for threshold in _thresholds(plateaus, goal, geometry.name):
        cells = sets.at(threshold)
        mesh = _improved_mesh(cells, name=geometry.name)
        measured = mesh.measurement
        if measured.is_sound and measured.has_topology(cells.predicted):
            return BackgroundResult(mesh, threshold, cells, fractions, plateaus)
        failed = ", ".join(f"{c.found} {c.name}" for c in measured.checks if not c.holds)
    raise MeshError(
        f"the mesh is not sound: {failed or 'no threshold keeps a cell'}",
        where=geometry.name,
        expected="a mesh without inverted elements",
        remedy="use another threshold, or a background with better or smaller cells where pinches "
        "crowd",
    )


def require_goal(goal: Goal) -> None:
    """Raise an error for goals that are not available with a background.

    Parameters
    ----------
    goal
        How the threshold is chosen.

    Raises
    ------
    ConfigError
        It has persistence or single features.
    """
    wrong = "`persistence`" if goal.persistence is not None else "`features`"
    if goal.persistence is not None or goal.features:
        raise ConfigError(
            f"{wrong} with a background mesh",
            where="goal",
            expected="a threshold, Betti numbers, the volume, or the last two together",
            remedy="ask for Betti numbers",
        )


def tabulate(sets: BackgroundCellSets, fractions: BackgroundFractions) -> pd.DataFrame:
    """Return the topology at every threshold, with the number and volume of the kept cells.

    Parameters
    ----------
    sets
        The cells of every threshold.
    fractions
        Their fractions.

    Returns
    -------
    plateaus
        The columns of `tusqh.topology.topology.Topology.curves`; `threshold`, the middle of the
        plateau; `cells`; `volume_ratio`, the volume of the kept cells over that of the
        fractions; and `raw_agrees`: every pinch follows its vote, so the mesh has these numbers.
    """
    plateaus = sets.topology.curves.copy()
    plateaus["threshold"] = (plateaus["upper"] + plateaus["lower"]) / 2
    values = sets.topology.values.cells
    order = np.argsort(-values, kind="stable")
    volumes = np.append(0.0, np.cumsum(fractions.background.volumes[order]))
    levels = np.rint(plateaus["upper"] / RESOLUTION).astype(np.int64)
    n_kept = np.searchsorted(-values[order].astype(np.int64), -levels, side="right")
    plateaus["cells"] = n_kept
    wanted = fractions.volume()
    plateaus["volume_ratio"] = volumes[n_kept] / wanted if wanted > 0 else np.nan
    plateaus["raw_agrees"] = True
    return plateaus


def _thresholds(plateaus: pd.DataFrame, goal: Goal, name: str) -> Iterator[float]:
    """Yield the thresholds to try."""
    if goal.target is None and goal.volume is None:
        yield 0.5 if goal.threshold is None else goal.threshold
        return
    is_wanted = np.asarray(plateaus["cells"] > 0)
    if goal.target is not None:
        is_wanted = is_wanted & np.asarray(matches(plateaus, goal.target))
        if not is_wanted.any():
            raise TopologyError(
                f"no threshold gives {goal.target}",
                where=name,
                expected="one of\n" + list_reachable(plateaus),
                remedy="ask for one of these, or use a finer background",
            )
    if goal.volume is not None:
        errors = (plateaus["volume_ratio"] - 1).abs().where(pd.Series(is_wanted), np.inf)
        best = errors.sort_values(kind="stable").index[: min(_TRIALS, int(is_wanted.sum()))]
        yield from plateaus.loc[best, "threshold"].to_list()
        return
    ranked = rank_candidates(plateaus, pd.Series(is_wanted))
    yield from ranked["threshold"].to_list()[:_TRIALS]


def _improved_mesh(cells: BackgroundCells, *, name: str) -> VolumeMesh:
    """Return the mesh of kept cells, its worst elements improved."""
    mesh, is_new, on_rim = build_mesh(cells, name=name)
    corners = mesh.cells.astype(np.int64)
    return replace(mesh, points=improve(mesh.points, corners, is_new, on_rim))
