"""Fit the boundary of a quad mesh to its target; the mesh stays valid and keeps its topology."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import pandas as pd

from tusqh.fitting.distances import measure_distances
from tusqh.fitting.fitted import FELL_BACK_COLUMNS, Fitted
from tusqh.fitting.left_out import CHANGED, NO_SURFACE, find_loose, list_left_out
from tusqh.fitting.planar.boundary import Boundary, Goals
from tusqh.fitting.planar.crossings import find_components, find_crossing_points, find_runs
from tusqh.fitting.planar.energy import move_if_valid, sweep_points
from tusqh.fitting.planar.pillow import Layered, add_layer
from tusqh.fitting.skin import rows_of_facets
from tusqh.fitting.target import Target, to_cells
from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.meshes.jacobians import QUAD_NEIGHBOURS, smallest_jacobians
from tusqh.meshes.volume_mesh import BRIDGE, VolumeMesh

#: Weights of the lines in the rounds, and sweeps in a round.
_WEIGHTS = (5.0, 10.0, 20.0, 40.0, 80.0, 150.0, 300.0, 600.0, 1200.0, 2500.0, 5e3, 1e4, 2e4)
_SWEEPS = 3

#: Sides of quads from the boundary within which points move.
_RINGS = 6

#: Scaled Jacobian below which points give way, the factor of their weight, and the rounds.
_GIVES_WAY, _LESS, _ROUNDS = 0.45, 0.3, 8

#: Sides of quads from a bad quad within which points then move.
_AROUND = 2

#: Power of the shape of quads in these rounds, which weighs bad quads more.
_POWER = 6.0

#: Rounds in which crossing sides are pulled apart.
_REPAIRS = 4

#: Smallest scaled Jacobian that moving a point exactly onto a side of the box may leave.
_LEAST = 0.3

#: Points at most this far from a side of the box move onto it, in cells.
_SNAP = 0.2


def fit_quads(mesh: VolumeMesh, target: Target, *, fixed: BoolArray | None = None) -> Fitted:
    """Return a mesh of quads whose boundary lies on the outline where that is possible.

    Parameters
    ----------
    mesh
        The mesh of a threshold, valid and with a manifold boundary.
    target
        Where its boundary should lie.
    fixed
        Points that do not move, shape (n,); None: all may.
    """
    start = to_cells(mesh.points, target.grid)
    layered = add_layer(start, mesh.cells)
    is_held = _held_sides(mesh, layered, target)
    boundary = Boundary.of(layered, target, is_held)
    is_free = boundary.is_free.copy()
    if fixed is not None and fixed.any():
        _fix(layered, fixed, is_free)
    run = _Run(boundary, layered.points.copy(), is_free)
    run.fit()
    run.put_on_sides()
    run.finish()
    fitted = _to_mesh(mesh, layered, run.points, target)
    if not (fitted.jacobians.determinant > 0).all():
        run.note(np.unique(layered.sides), "the staircase stays", "a quad would be invalid")
        return Fitted(mesh, measure_distances(mesh, target), run.rows(target, mesh))
    run.note_without(is_held)
    pieces = boundary.pieces(run.points)
    patch = None
    if pieces is not None:
        patch = pieces[rows_of_facets(fitted.facets.boundary, layered.sides)]
    return Fitted(fitted, measure_distances(fitted, target), run.rows(target, fitted), patch=patch)


@dataclass
class _Run:
    """A mesh while it moves.

    Parameters
    ----------
    boundary
        What attracts it.
    points
        Coordinates in cells, shape (n, 2).
    is_free
        Coordinates that may change, shape (n, 2).
    fell_back
        Rows so far, without units: points, what, why.
    """

    boundary: Boundary
    points: FloatArray
    is_free: BoolArray
    fell_back: list[tuple[IntArray, str, str]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.layered = self.boundary.layered
        self.order = self.layered.near(self.layered.sides, _RINGS)
        self.goals = self.boundary.goals(self.points, _WEIGHTS[0])

    def sweeps(self, goals: Goals, n: int, *, power: float, order: IntArray | None = None) -> None:
        """Move all points near the boundary, or some of them, a few times."""
        first, corners = self.layered.corners_at
        moved = np.zeros(len(self.points))
        for _ in range(n):
            sweep_points(
                self.points,
                self.layered.cells,
                QUAD_NEIGHBOURS,
                first,
                corners,
                self.order if order is None else order,
                self.is_free,
                goals.weight,
                goals.matrix,
                goals.place,
                power,
                moved,
            )

    def fit(self) -> None:
        """Smooth the staircase, then follow the lines with growing weights."""
        n = len(self.points)
        on_boundary = np.unique(self.layered.sides)
        smooth = Goals(
            np.zeros(n), np.zeros((n, 3)), self.boundary.smoothed, np.zeros(n, dtype=np.bool_)
        )
        smooth.weight[on_boundary] = 3.0
        smooth.matrix[on_boundary] = (1.0, 0.0, 1.0)
        self.sweeps(smooth, 8, power=1.0)
        for weight in _WEIGHTS:
            self.goals = self.boundary.goals(self.points, weight)
            self.sweeps(self.goals, _SWEEPS, power=2.0)

    def put_on_sides(self) -> None:
        """Move points of sides of the box exactly onto them, where quads stay good."""
        boundary, places = self.boundary, self.points.copy()
        on_side = np.zeros(len(places), dtype=np.bool_)
        sides, labels, patches = self.layered.sides, boundary.labels, boundary.patches
        rows = np.flatnonzero(labels >= 0)
        rows = rows[patches.axis[labels[rows]] >= 0]
        axis, place = patches.axis[labels[rows]], patches.place[labels[rows]]
        for k in range(2):
            places[sides[rows, k], axis] = place
            on_side[sides[rows, k]] = True
        way = np.linalg.norm(places - self.points, axis=1)
        order = np.flatnonzero(on_side & (way > 0) & (way < _SNAP))
        done = np.ones(len(places), dtype=np.bool_)
        first, corners = self.layered.corners_at
        move_if_valid(
            self.points,
            self.layered.cells,
            QUAD_NEIGHBOURS,
            first,
            corners,
            order,
            places,
            _LEAST,
            done,
        )
        for k in range(2):
            points = sides[rows, k]
            is_on = self.points[points, axis] == place
            self.is_free[points[is_on], axis[is_on]] = False
        self.note(np.flatnonzero(~done), "not exactly on a side of the box", "a quad would be bad")

    def finish(self) -> None:
        """Let the points of bad quads leave their lines, and pull crossing sides apart."""
        for turn in range(_REPAIRS):
            self._give_way()
            crossing = find_crossing_points(self.points, self.layered.sides)
            if len(crossing) == 0:
                break
            self.note(crossing, "near the staircase", "sides of the boundary would cross")
            self._separate(crossing, turn)
        self._return()
        scaled = smallest_jacobians(self.points, self.layered.cells).scaled
        bad = self.layered.cells[scaled < _GIVES_WAY]
        is_left = self.goals.is_led & np.isin(np.arange(len(self.points)), bad)
        self.note(np.flatnonzero(is_left), "off the surface", "quads would be bad")

    def _give_way(self) -> None:
        """Lower the weights of the points of bad quads, and move all."""
        for _ in range(_ROUNDS):
            bad = smallest_jacobians(self.points, self.layered.cells).scaled < _GIVES_WAY
            if not bad.any():
                return
            self.goals.weight[np.unique(self.layered.cells[bad])] *= _LESS
            near = self.layered.near(self.layered.cells[bad], _AROUND)
            self.sweeps(self.goals, _SWEEPS, power=_POWER, order=near)

    def _separate(self, crossing: IntArray, turn: int) -> None:
        """Pull the boundary near crossing sides to the staircase, farther in every turn."""
        layered, goals = self.layered, self.goals
        held = np.intersect1d(layered.near(crossing, 2 + turn), layered.sides)
        goals.weight[held] = 30.0 * 3**turn
        goals.matrix[held] = (1.0, 0.0, 1.0)
        goals.place[held] = self.boundary.start[held]
        goals.is_led[held] = False
        self.sweeps(goals, 6, power=1.0)

    def _return(self) -> None:
        """Put components that still cross back to their staircase, which crosses nothing."""
        layered, start = self.layered, self.boundary.start
        crossing = find_crossing_points(self.points, layered.sides)
        component = find_components(layered.cells, len(self.points))
        while len(crossing):
            back = np.flatnonzero(np.isin(component, np.unique(component[crossing])))
            on_boundary = np.intersect1d(back, layered.sides)
            self.points[back] = start[back]
            self.is_free[on_boundary] = False
            self.goals.is_led[on_boundary] = False
            self.note(on_boundary, "the staircase stays", "sides of the boundary would cross")
            self.sweeps(self.goals, 4 * _SWEEPS, power=2.0)
            crossing = find_crossing_points(self.points, layered.sides)

    def note(self, points: IntArray, what: str, why: str) -> None:
        """Add a row on points, if there are any."""
        if len(points):
            self.fell_back.append((points, what, why))

    def note_without(self, is_held: BoolArray) -> None:
        """Add rows on points that follow no surface."""
        sides = self.layered.sides
        at_held, points = np.unique(sides[is_held]), np.unique(sides)
        self.note(at_held, "smoothed staircase", CHANGED)
        is_alone = ~self.goals.is_led[points] | find_loose(
            self.points[points], self.boundary.attraction.target
        )
        alone = np.setdiff1d(points[is_alone], at_held)
        self.note(alone, "smoothed staircase", NO_SURFACE)

    def rows(self, target: Target, mesh: VolumeMesh) -> pd.DataFrame:
        """Return a row for each connected part, and for each part of the surface that is left out.

        Places are the middles of their points, in model units.
        """
        columns = [c for c in FELL_BACK_COLUMNS if c != "z"]
        grid = target.grid
        rows = []
        for points, what, why in self.fell_back:
            for part in find_runs(points, self.layered.sides):
                x, y = grid.to_points(self.points[part].mean(axis=0)[None])[0]
                rows.append((float(x), float(y), len(part), what, why))
        left_out = list_left_out(mesh, target)
        found = pd.DataFrame(rows, columns=columns)
        return pd.concat([found, left_out], ignore_index=True) if len(found) else left_out


def _held_sides(mesh: VolumeMesh, layered: Layered, target: Target) -> BoolArray:
    """Return the sides of bridges, and those beside cells that topology added or removed."""
    is_held = np.asarray(mesh.kind[layered.quads] == BRIDGE)
    if target.changed is None:
        return is_held
    ends = layered.points[layered.sides]
    along = ends[:, 1] - ends[:, 0]
    normal = np.stack([along[:, 1], -along[:, 0]], axis=1)
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    for sign in (-0.25, 0.25):
        cell = np.floor(ends.mean(axis=1) + sign * normal).astype(np.int64)
        is_in = ((cell >= 0) & (cell < target.grid.shape)).all(axis=1)
        is_held[is_in] |= target.changed[tuple(cell[is_in].T)]
    return is_held


def _fix(layered: Layered, fixed: BoolArray, is_free: BoolArray) -> None:
    """Hold points of the mesh, on its boundary their copies in the layer."""
    inner, outer = layered.inner_sides.ravel(), layered.sides.ravel()
    is_free[outer[fixed[inner]]] = False
    on_boundary = np.zeros(len(fixed), dtype=np.bool_)
    on_boundary[inner] = True
    is_free[np.flatnonzero(fixed & ~on_boundary)] = False


def _to_mesh(mesh: VolumeMesh, layered: Layered, points: FloatArray, target: Target) -> VolumeMesh:
    """Return the mesh in model units; the quads of the layer are of the kind that they cover."""
    grid = target.grid
    return replace(
        mesh,
        points=grid.to_points(points),
        cells=layered.cells,
        kind=np.concatenate([mesh.kind, mesh.kind[layered.quads]]),
        grid_cell=np.concatenate([mesh.grid_cell, mesh.grid_cell[layered.quads]]),
    )
