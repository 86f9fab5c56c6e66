"""Manufactured solutions, conservation, and what a simulation refuses."""

import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from plain_meshes import two_islands, unit_square

from tusqh.errors import SimulationError
from tusqh.settings.simulation import Simulation
from tusqh.simulate.components import count_matrix_components
from tusqh.simulate.diffusion import lump, march, simulate_diffusion
from tusqh.simulate.operators import assemble
from tusqh.simulate.snapshots import read_snapshot, write_snapshots

DIFFUSIVITY = 0.3


def error_at_end(n, n_steps, *, wobble=0.0, end=0.1):
    """Return the L2 error of the decaying mode cos(pi x) cos(pi y), which has no boundary flux."""
    operators = assemble(unit_square(n, wobble))
    mode = np.cos(np.pi * operators.nodes[:, 0]) * np.cos(np.pi * operators.nodes[:, 1])
    lumped = lump(operators.mass)
    final = march(
        operators,
        lumped,
        mode,
        diffusivity=DIFFUSIVITY,
        time_step=end / n_steps,
        steps=(n_steps,),
    )[-1]
    exact = mode * np.exp(-2 * np.pi**2 * DIFFUSIVITY * end)
    return float(np.sqrt((lumped * (final - exact) ** 2).sum()))


@pytest.mark.parametrize("wobble", [0.0, 0.15])
def test_second_order_in_space(wobble):
    # Time steps shrink with h squared, so that the error in space dominates.
    errors = [error_at_end(n, 4 * n**2 // 16, wobble=wobble) for n in (8, 16, 32)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx(2.0, abs=0.25)


def test_first_order_in_time():
    reference = error_at_end(64, 4000)
    errors = [error_at_end(64, steps) for steps in (10, 20, 40)]
    assert reference < errors[-1] / 10
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx(1.0, abs=0.15)


def test_order_two_elements_have_the_same_mass_and_more_unknowns():
    linear, quadratic = assemble(unit_square(4)), assemble(unit_square(4), order=2)
    assert quadratic.nodes.shape == (81, 2)
    assert linear.mass.sum() == pytest.approx(quadratic.mass.sum(), rel=1e-13)
    energy = quadratic.nodes[:, 0] @ (quadratic.stiffness @ quadratic.nodes[:, 0])
    assert energy == pytest.approx(1.0, rel=1e-12)


def test_the_amount_stays_and_nothing_leaks_to_the_other_island():
    result = simulate_diffusion(
        two_islands(), Simulation(source=(0.5, 0.5), radius=1.0, refinements=1)
    )
    assert result.table["amount_relative_error"].abs().max() <= 1e-12
    assert (result.fields[:, result.points[:, 0] > 1.5] == 0).all()
    assert result.table["undershoot"].max() == 0
    # After a long time the concentration is uniform.
    assert result.table["step"].tolist() == [0, 50, 100, 200, 400, 800]
    even = simulate_diffusion(two_islands(), Simulation((0.5, 0.5), time_step=1.0)).fields[-1]
    assert even.max() == pytest.approx(1000.0, rel=1e-6)


def test_snapshots_are_files_that_paraview_plays(tmp_path):
    result = simulate_diffusion(unit_square(4), Simulation(time_step=0.5), steps=(0, 2, 4))
    files = [tmp_path / f"c_{k}.vtu" for k in range(3)]
    write_snapshots(tmp_path / "c.pvd", files, result)
    entries = ElementTree.parse(tmp_path / "c.pvd").findall("./Collection/DataSet")
    assert [float(e.get("timestep")) for e in entries] == [0.0, 1.0, 2.0]
    assert [e.get("file") for e in entries] == [f.name for f in files]
    points, cells, field = read_snapshot(files[2])
    assert np.array_equal(points, result.points)
    assert np.array_equal(cells, result.cells)
    assert np.array_equal(field, result.fields[2])
    assert sorted(p.name for p in tmp_path.iterdir()) == ["c.pvd", "c_0.vtu", "c_1.vtu", "c_2.vtu"]


def test_the_same_bits_every_time():
    first, second = (simulate_diffusion(unit_square(6)).fields for _ in range(2))
    assert np.array_equal(first, second)


def test_the_matrix_has_the_components_of_the_mesh():
    assert count_matrix_components(unit_square(3)) == 1
    assert count_matrix_components(two_islands()) == 2
    eigenvalues = np.linalg.eigvalsh(assemble(two_islands()).stiffness.toarray())
    assert (np.abs(eigenvalues) < 1e-12).sum() == 2


def test_a_source_outside_names_model_and_nearest_point():
    with pytest.raises(SimulationError, match=r"source \[1.5, 0.5\] of model 'islands'") as caught:
        simulate_diffusion(two_islands(), Simulation(source=(1.5, 0.5)))
    assert "nearest point is [" in caught.value.expected


@pytest.mark.parametrize(
    "numbers",
    [
        {"radius": 0.0},
        {"diffusivity": -1.0},
        {"time_step": float("nan")},
        {"amount": 0.0},
    ],
)
def test_numbers_out_of_range(numbers):
    with pytest.raises(SimulationError, match="out of range for model 'unit square'"):
        simulate_diffusion(unit_square(2), Simulation(**numbers))


@pytest.mark.parametrize("steps", [(5, 3), (-1, 3), ()])
def test_steps_out_of_range(steps):
    with pytest.raises(SimulationError, match="out of range for model 'unit square'"):
        simulate_diffusion(unit_square(2), steps=steps)
