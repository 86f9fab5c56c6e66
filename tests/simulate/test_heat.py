"""Diffusion of heat in 3D: order of convergence, conservation, bounds, refinement of the torus."""

import numpy as np
import pytest
from plain_meshes import unit_cube

from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.errors import SimulationError
from tusqh.readers.files import read_file
from tusqh.sampling.fractions import sample_fractions
from tusqh.sampling.layout import lay_grid
from tusqh.settings.simulation import Simulation
from tusqh.simulate.components import count_matrix_components
from tusqh.simulate.diffusion import lump, march, simulate_diffusion
from tusqh.simulate.operators import assemble
from tusqh.simulate.snapshots import read_snapshot, write_snapshots


def mesh_of(repository, name, cells):
    soup = read_file(repository / f"data_sources/solids/{name}.stl").geometry
    fractions = sample_fractions(soup, lay_grid(soup, None, cells=cells))
    return build_mesh(CellSets(fractions).at(0.5), fractions.grid, name=name).mesh


def test_second_order_in_space():
    """The mode cos(pi x) cos(pi y) cos(pi z), which has no flux through the faces, decays."""
    errors = []
    for n, n_steps in ((4, 4), (8, 16), (16, 64)):
        operators = assemble(unit_cube(n))
        mode = np.cos(np.pi * operators.nodes).prod(axis=1)
        lumped = lump(operators.mass)
        final = march(
            operators, lumped, mode, diffusivity=0.1, time_step=0.4 / n_steps, steps=(n_steps,)
        )[-1]
        exact = mode * np.exp(-3 * np.pi**2 * 0.1 * 0.4)
        errors.append(float(np.sqrt((lumped * (final - exact) ** 2).sum())))
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(2.0, abs=0.3)


def test_heat_stays_within_bounds_and_agrees_with_the_refined_torus(repository):
    torus = mesh_of(repository, "torus", 16)
    steps = (0, 5, 10, 20)
    how = {"source": (10.0, 0.3, 0.2), "radius": 3.0, "diffusivity": 1.0, "time_step": 1.0}
    coarse = simulate_diffusion(torus, Simulation(**how), steps=steps)
    fine = simulate_diffusion(torus, Simulation(**how, refinements=1), steps=steps)
    for result in (coarse, fine):
        assert result.table["amount_relative_error"].abs().max() < 1e-11
        assert (result.table["undershoot"] <= 1e-6).all()
        assert (np.diff(result.table["concentration_max"]) <= 0).all()
    assert len(fine.points) > 6 * len(coarse.points)
    largest = [result.table["concentration_max"].to_numpy() for result in (coarse, fine)]
    assert largest[0][1:] == pytest.approx(largest[1][1:], rel=0.06)


def test_each_shell_is_a_component_of_the_matrix(repository):
    assert count_matrix_components(mesh_of(repository, "nested_spheres", 14)) == 2
    assert count_matrix_components(mesh_of(repository, "hollow_sphere", 12)) == 1


def test_a_source_in_the_void_is_refused(repository):
    hollow = mesh_of(repository, "hollow_sphere", 12)
    with pytest.raises(SimulationError, match="lies outside its mesh"):
        simulate_diffusion(hollow, Simulation(source=(0.0, 0.0, 0.0)), steps=(0, 1))
    simulate_diffusion(hollow, Simulation(source=(8.0, 0.0, 0.0)), steps=(0, 1))


def test_snapshots_of_hexes_are_read_back(repository, tmp_path):
    result = simulate_diffusion(mesh_of(repository, "torus", 12), steps=(0, 2))
    files = [tmp_path / "a.vtu", tmp_path / "b.vtu"]
    write_snapshots(tmp_path / "all.pvd", files, result)
    points, cells, field = read_snapshot(files[1])
    assert np.allclose(points, result.points)
    assert np.array_equal(cells, result.cells)
    assert np.allclose(field, result.fields[1])
