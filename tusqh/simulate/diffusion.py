"""Transient diffusion with no flux through the boundary: a contaminant in 2D, heat in 3D.

``dc/dt = div(D grad c)`` with H1 elements and implicit Euler: ``(M + dt D K) c_new = M c_old``.
At order 1 the mass matrix is lumped (row sums), which keeps the second order of the elements and
lets the scheme inherit the maximum principle wherever the stiffness matrix has no positive
entries off its diagonal: true of the square cells, not of every trapezoid, so the undershoot is
measured and reported.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from scipy.sparse import csr_matrix, diags_array
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import cg, splu

from tusqh.errors import SimulationError
from tusqh.grid import FloatArray, IntArray
from tusqh.meshes.facets import HEX_FACETS
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.simulate.operators import Operators, assemble

#: Largest relative change of the total mass that is accepted.
MASS_TOLERANCE = 1e-10

#: Relative residual at which conjugate gradients stop.
_CG_TOLERANCE = 1e-13

Progress = Callable[[int, int], None]
Solver = Callable[[FloatArray, FloatArray], FloatArray]


@dataclass(frozen=True)
class DiffusionResult:
    """Snapshots of a simulation.

    Parameters
    ----------
    points, cells
        The mesh the fields live on, after refinement.
    fields
        Concentration at the points, shape (n_snapshots, n_points), kg per model unit**2; in 3D
        the density of heat (temperature times heat capacity), J per model unit**3.
    table
        One row per snapshot: step, time_s, mass_kg, mass_relative_error, concentration_min,
        concentration_max, undershoot (largest negative value over the initial maximum), unit.
    """

    points: FloatArray
    cells: IntArray
    fields: FloatArray
    table: pd.DataFrame


def simulate_diffusion(
    mesh: VolumeMesh,
    *,
    source: Sequence[float] | None = None,
    radius: float | None = None,
    amount: float = 1000.0,
    diffusivity: float = 1.0,
    time_step: float | None = None,
    steps: Sequence[int] = (0, 50, 100, 200, 400, 800),
    refinements: int = 0,
    progress: Progress | None = None,
) -> DiffusionResult:
    """Return how a contaminant released at a point spreads.

    Parameters
    ----------
    mesh
        The mesh, in m.
    source
        Where it is released, in m; None: the point farthest from the boundary.
    radius
        Standard deviation of the Gaussian release, in m; None: twice the largest element side.
    amount
        Released mass, in kg; in 3D released heat, in J.
    diffusivity
        D, in m^2/s.
    time_step
        In s; None: such that the last step sees a spread ``sqrt(4 D t)`` of a third of the
        mesh's longest side.
    steps
        Time steps of the snapshots, ascending.
    refinements
        Uniform refinements of the mesh.
    progress
        Called with (steps done, steps in all).

    Raises
    ------
    SimulationError
        The mesh is rejected, the source lies outside the mesh, a number is out of range, or
        mass is not conserved; the message names the model.
    """
    n_steps = _check_numbers(mesh.name, amount, diffusivity, radius, time_step, steps)
    operators = assemble(mesh, refinements=refinements)
    extent = float(np.ptp(mesh.points, axis=0).max())
    if radius is None:
        sides = mesh.points[mesh.cells] - mesh.points[np.roll(mesh.cells, 1, axis=1)]
        radius = 2 * float(np.linalg.norm(sides, axis=-1).max())
    if time_step is None:
        time_step = (extent / 3) ** 2 / (4 * diffusivity * max(n_steps, 1))
    place = _deepest_point(mesh) if source is None else np.asarray(source, dtype=np.float64)
    lumped = lump(operators.mass)
    initial = release(mesh, operators, place, radius=radius) * _component_of(operators, place)
    initial *= amount / (lumped * initial).sum()
    fields = march(
        operators,
        lumped,
        initial,
        diffusivity=diffusivity,
        time_step=time_step,
        steps=steps,
        progress=progress,
    )
    table = _tabulate(fields, lumped, amount, time_step, steps, dim=mesh.dim)
    worst = float(table["mass_relative_error"].abs().max())
    if not worst <= MASS_TOLERANCE:
        raise SimulationError(
            f"the mass of model {mesh.name!r} changes by {worst:.2e} relative",
            where=mesh.name,
            expected=f"at most {MASS_TOLERANCE:g}",
            remedy="use a smaller time step, and report this mesh",
        )
    return DiffusionResult(operators.points, operators.cells, fields, table)


def lump(mass: csr_matrix) -> FloatArray:
    """Return the row sums of a mass matrix, shape (n,)."""
    return np.asarray(mass.sum(axis=1)).ravel()


def march(
    operators: Operators,
    lumped: FloatArray,
    initial: FloatArray,
    *,
    diffusivity: float,
    time_step: float,
    steps: Sequence[int],
    progress: Progress | None = None,
) -> FloatArray:
    """Return the fields at some steps of implicit Euler, shape (len(steps), n_dofs).

    In 2D the matrix is factorised once, so that the time does not depend on the stiffness; in
    3D, where factors fill memory, every step is solved by conjugate gradients.
    """
    mass = diags_array(lumped).tocsc()
    system = mass + time_step * diffusivity * operators.stiffness.tocsc()
    solve = _factorised(system) if operators.nodes.shape[1] == 2 else _iterated(system.tocsr())
    wanted, fields = set(steps), []
    field = initial
    for step in range(max(steps) + 1):
        if step > 0:
            field = solve(lumped * field, field)
        if step in wanted:
            fields.append(field)
        if progress is not None:
            progress(step, max(steps))
    return np.array(fields)


def _factorised(system: Any) -> Solver:
    factor = splu(
        system.tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        options={"SymmetricMode": True},
        diag_pivot_thresh=0.0,
    )
    return lambda right, guess: np.asarray(factor.solve(right))


def _iterated(system: csr_matrix) -> Solver:
    """Return conjugate gradients with Jacobi's preconditioner, from the last field on."""
    inverse = diags_array(1 / system.diagonal()).tocsr()

    def solve(right: FloatArray, guess: FloatArray) -> FloatArray:
        field, failed = cg(system, right, x0=guess, rtol=_CG_TOLERANCE, M=inverse, maxiter=10_000)
        if failed:
            raise SimulationError(
                f"conjugate gradients did not converge in {failed} iterations",
                where="simulation",
                expected=f"a relative residual of {_CG_TOLERANCE:g}",
                remedy="use a smaller time step",
            )
        return np.asarray(field)

    return solve


def release(
    mesh: VolumeMesh, operators: Operators, place: FloatArray, *, radius: float
) -> FloatArray:
    """Return a Gaussian around a place of the mesh at the nodes, its largest value about 1."""
    _require_inside(mesh, place)
    squared = ((operators.nodes - place) ** 2).sum(axis=1)
    return np.asarray(np.exp(-squared / (2 * radius**2)))


def _component_of(operators: Operators, place: FloatArray) -> FloatArray:
    """Return 1 at the nodes of the component that holds a place, 0 elsewhere."""
    _, labels = connected_components(operators.stiffness, directed=False)
    nearest = int(((operators.nodes - place) ** 2).sum(axis=1).argmin())
    return np.asarray(labels == labels[nearest], dtype=np.float64)


def _require_inside(mesh: VolumeMesh, place: FloatArray) -> None:
    """Raise unless a place lies in an element (outside of none of its facets)."""
    corners = mesh.points[mesh.cells]
    if mesh.dim == 2:
        sides = np.roll(corners, -1, axis=1) - corners
        to_place = place - corners
        outside = sides[..., 1] * to_place[..., 0] - sides[..., 0] * to_place[..., 1]
    else:
        a, b, c, d = np.moveaxis(corners[:, HEX_FACETS], 2, 0)
        normals = np.cross(c - a, d - b)  # Facets of the templates are flat.
        outside = np.einsum("mfi,mfi->mf", normals, place - (a + b + c + d) / 4)
    slack = 1e-9 * np.abs(outside).max(initial=0.0)
    if not (outside <= slack).all(axis=1).any():
        nearest = mesh.points[((mesh.points - place) ** 2).sum(axis=1).argmin()]
        raise SimulationError(
            f"the source {place.tolist()} of model {mesh.name!r} lies outside its mesh",
            where=mesh.name,
            expected=f"a point in the mesh; its nearest point is {nearest.tolist()}",
            remedy="move `simulation.source` into the mesh, or leave it out",
        )


def _deepest_point(mesh: VolumeMesh) -> FloatArray:
    """Return the centre of the element that is farthest from the boundary."""
    from scipy.spatial import cKDTree

    from tusqh.meshes.facets import find_facets

    facets = find_facets(mesh.cells)
    boundary = np.unique(facets.corners[facets.on_boundary])
    centres = mesh.points[mesh.cells].mean(axis=1)
    distance, _ = cKDTree(mesh.points[boundary]).query(centres)
    return np.asarray(centres[int(distance.argmax())])


def _tabulate(
    fields: FloatArray,
    lumped: FloatArray,
    amount: float,
    time_step: float,
    steps: Sequence[int],
    *,
    dim: int,
) -> pd.DataFrame:
    mass = (fields * lumped).sum(axis=1)
    smallest, largest = fields.min(axis=1), fields.max(axis=1)
    return pd.DataFrame(
        {
            "step": list(steps),
            "time_s": np.array(steps) * time_step,
            "mass_kg": mass,
            "mass_relative_error": mass / amount - 1,
            "concentration_min": smallest,
            "concentration_max": largest,
            "undershoot": -np.minimum(0.0, smallest) / largest[0] + 0.0,
            "unit": "kg/m^2" if dim == 2 else "J/m^3",
        }
    )


def _check_numbers(
    name: str,
    amount: float,
    diffusivity: float,
    radius: float | None,
    time_step: float | None,
    steps: Sequence[int],
) -> int:
    """Raise for numbers out of range; return the last step."""
    numbers = {"amount": amount, "diffusivity": diffusivity, "radius": radius}
    numbers["time_step"] = time_step
    bad = [
        f"{key} = {value}"
        for key, value in numbers.items()
        if value is not None and not (np.isfinite(value) and value > 0)
    ]
    if list(steps) != sorted(set(steps)) or not steps or min(steps) < 0:
        bad.append(f"steps = {list(steps)}")
    if bad:
        raise SimulationError(
            f"out of range for model {name!r}: {', '.join(bad)}",
            where=name,
            expected="positive, finite numbers and ascending steps from 0",
            remedy="correct the model's `simulation` entry",
        )
    return max(steps)
