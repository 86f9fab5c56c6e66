"""Simulate transient diffusion without boundary flux, of a contaminant in 2D or heat in 3D.

The equation ``dc/dt = div(D grad c)`` is discretized with H1 elements and implicit Euler:
``(M + dt D K) c_new = M c_old``.  At order 1 the mass matrix is lumped (row sums).  This keeps the
second order of the elements, and the scheme satisfies the maximum principle wherever the stiffness
matrix has no positive off-diagonal entries.  This holds for square cells but not for every
trapezoid, so the undershoot is measured and reported.

The mesh is in the model's unit of length.  It is converted to SI units once, in
`simulate_diffusion`, by scaling the matrices; see `tusqh.simulate.units`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from scipy.sparse import csr_matrix, diags_array
from scipy.sparse.linalg import cg, splu

from tusqh.errors import SimulationError
from tusqh.geometry.units import ASSUMED
from tusqh.grid import FloatArray, IntArray
from tusqh.meshes.regions import Regions
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.progress import Report
from tusqh.settings.simulation import DIFFUSIVITY, Simulation
from tusqh.simulate.operators import Operators, assemble
from tusqh.simulate.release import release
from tusqh.simulate.units import amount_unit, concentration_unit, simulated_length

#: Largest accepted relative change of the total amount.
AMOUNT_TOLERANCE = 1e-10

#: Relative residual at which conjugate gradients stop.
_CG_TOLERANCE = 1e-13

Solver = Callable[[FloatArray, FloatArray], FloatArray]


@dataclass(frozen=True)
class DiffusionResult:
    """Snapshots of a simulation.

    Parameters
    ----------
    points, cells
        The mesh of the fields, after refinement; points in the model's unit.
    fields
        Concentration at the points, shape (n_snapshots, n_points), in kg/m^2; in 3D the density
        of heat (temperature times volumetric heat capacity), in J/m^3.  If the size of the model's
        unit is unknown, that unit replaces m.
    table
        One row per snapshot: step, time_s, amount, amount_unit (kg or J), amount_relative_error,
        concentration_min, concentration_max, concentration_unit, undershoot (ratio of the largest
        negative value to the initial maximum).
    """

    points: FloatArray
    cells: IntArray
    fields: FloatArray
    table: pd.DataFrame


def simulate_diffusion(
    mesh: VolumeMesh,
    simulation: Simulation | None = None,
    *,
    diffusivities: FloatArray | None = None,
    unit: str | None = None,
    steps: Sequence[int] = (0, 50, 100, 200, 400, 800),
    progress: Report | None = None,
) -> DiffusionResult:
    """Simulate the diffusion of an amount released at a point.

    Parameters
    ----------
    mesh
        The mesh, in the model's unit.
    simulation
        What is released, where, and how it spreads; None: with the defaults.
    diffusivities
        Diffusivity of every element, in m^2/s, shape (m,), such as that of its material; None: that
        of `simulation` everywhere.
    unit
        The model's unit of length, see `tusqh.geometry.units.METRES`; None: that of the mesh, or
        metres if that is not known.
    steps
        Time steps of the snapshots, ascending.
    progress
        Called with (steps done, total number of steps).

    Returns
    -------
    DiffusionResult
        Fields and table in SI units, points in the model's unit.

    Raises
    ------
    SimulationError
        The mesh is rejected, the source lies outside the mesh, a number is out of range, or the
        amount is not conserved; the message names the model.
    """
    simulation = simulation or Simulation()
    n_steps = _check_numbers(mesh.name, simulation, steps)
    unit = unit or mesh.unit or ASSUMED
    factor, _ = simulated_length(unit)
    diffusivity = simulation.diffusivity or DIFFUSIVITY[mesh.dim]
    time_step = simulation.time_step
    if time_step is None:
        extent = factor * float(np.ptp(mesh.points, axis=0).max())
        time_step = (extent / 3) ** 2 / (4 * diffusivity * max(n_steps, 1))
    relative = None if diffusivities is None else diffusivities / diffusivity
    operators = assemble(mesh, refinements=simulation.refinements, coefficient=relative)
    initial = release(mesh, operators, source=simulation.source, radius=simulation.radius)
    scaled = operators.scaled(factor)
    lumped = lump(scaled.mass)
    initial *= simulation.amount / (lumped * initial).sum()
    fields = march(
        scaled,
        lumped,
        initial,
        diffusivity=diffusivity,
        time_step=time_step,
        steps=steps,
        progress=progress,
    )
    table = _tabulate(fields, lumped, simulation.amount, times=np.array(steps) * time_step)
    table.insert(0, "step", list(steps))
    table.insert(3, "amount_unit", amount_unit(mesh.dim))
    table.insert(7, "concentration_unit", concentration_unit(mesh.dim, unit))
    _require_conservation(table, mesh.name)
    return DiffusionResult(operators.points, operators.cells, fields, table)


def diffusivities_of(
    regions: Regions, by_name: Mapping[str, float], simulation: Simulation, *, dim: int
) -> FloatArray:
    """Return the diffusivity of every element of several materials, in m^2/s, shape (m,).

    Parameters
    ----------
    regions
        The material of every element.
    by_name
        Diffusivities of some materials; the others have that of the simulation.
    simulation
        The simulation.
    dim
        Dimension of the mesh, 2 or 3.
    """
    common = simulation.diffusivity or DIFFUSIVITY[dim]
    of_material = np.array([by_name.get(name, common) for name in regions.names])
    return np.asarray(of_material[regions.material], dtype=np.float64)


def lump(mass: csr_matrix) -> FloatArray:
    """Return the row sums of a mass matrix, shape (n,).

    Parameters
    ----------
    mass
        The matrix, shape (n, n).
    """
    return np.asarray(mass.sum(axis=1)).ravel()


def march(
    operators: Operators,
    lumped: FloatArray,
    initial: FloatArray,
    *,
    diffusivity: float,
    time_step: float,
    steps: Sequence[int],
    progress: Report | None = None,
) -> FloatArray:
    """Return the fields at given steps of implicit Euler.

    In 2D the matrix is factorised once.  In 3D the factors would fill the memory, so conjugate
    gradients solve every step.

    Parameters
    ----------
    operators
        Stiffness and nodes of the mesh.
    lumped
        Diagonal of the lumped mass matrix, shape (n_dofs,).
    initial
        The field at step 0, shape (n_dofs,).
    diffusivity
        Diffusivity, in the squared unit of length of the operators per second.
    time_step
        Time step, in s.
    steps
        Steps whose fields are returned, ascending.
    progress
        Called with (steps done, total number of steps).

    Returns
    -------
    numpy.ndarray
        The fields, shape (len(steps), n_dofs).

    Raises
    ------
    SimulationError
        Conjugate gradients do not converge.
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
    """Return a solver that factorises the matrix once."""
    factor = splu(
        system.tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        options={"SymmetricMode": True},
        diag_pivot_thresh=0.0,
    )
    return lambda right, guess: np.asarray(factor.solve(right))


def _iterated(system: csr_matrix) -> Solver:
    """Return conjugate gradients with Jacobi's preconditioner, starting from the last field."""
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


def _tabulate(
    fields: FloatArray, lumped: FloatArray, released: float, *, times: FloatArray
) -> pd.DataFrame:
    """Return time, amount and extremes of every snapshot."""
    amount = (fields * lumped).sum(axis=1)
    smallest, largest = fields.min(axis=1), fields.max(axis=1)
    return pd.DataFrame(
        {
            "time_s": times,
            "amount": amount,
            "amount_relative_error": amount / released - 1,
            "concentration_min": smallest,
            "concentration_max": largest,
            "undershoot": -np.minimum(0.0, smallest) / largest[0] + 0.0,
        }
    )


def _require_conservation(table: pd.DataFrame, name: str) -> None:
    """Raise an error unless every snapshot holds the released amount."""
    worst = float(table["amount_relative_error"].abs().max())
    if not worst <= AMOUNT_TOLERANCE:
        raise SimulationError(
            f"the total amount in model {name!r} changes by {worst:.2e} relative",
            where=name,
            expected=f"at most {AMOUNT_TOLERANCE:g}",
            remedy="use a smaller time step, and report this mesh",
        )


def _check_numbers(name: str, simulation: Simulation, steps: Sequence[int]) -> int:
    """Raise an error for numbers out of range, and return the last step."""
    numbers = {
        "amount": simulation.amount,
        "diffusivity": simulation.diffusivity,
        "radius": simulation.radius,
        "time_step": simulation.time_step,
    }
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
