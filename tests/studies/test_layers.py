"""Steady diffusion in two materials has the exact flux, and conserves it at the interface."""

from itertools import pairwise

import numpy as np
import pytest

from studies import layers
from tusqh.contacts import mesh_materials
from tusqh.errors import SimulationError
from tusqh.meshes.regions import Regions
from tusqh.settings.simulation import Simulation
from tusqh.simulate.diffusion import simulate_diffusion
from tusqh.simulate.operators import assemble
from tusqh.simulate.steady import solve_steady


def test_fluxes_of_walls_and_shells():
    table = layers.compare_layers()
    assert (table["jump"] == 0).all()  # below 5e-13; the file would show the rounding errors
    assert (table.query("case == 'wall'")["error"] == 0).all()
    for dimension in (2, 3):
        errors = table.query(f"case == 'shells' and dimension == {dimension}")["error"].tolist()
        assert all(b < 0.7 * a for a, b in pairwise(errors))


def test_the_flux_of_layers_in_parallel_is_the_sum():
    """Layers along the flux: each carries its share of the flux, and nothing crosses over."""
    labels = np.ones((8, 6), dtype=np.int64)
    labels[:, 2:] = 2
    found = mesh_materials(labels)
    x, y = found.mesh.points.T
    ends = {1.0: np.flatnonzero(x == 0), 0.0: np.flatnonzero(x == 8)}
    regions = Regions(found.names, found.material)
    field = solve_steady(found.mesh, regions, {"1": 3.0, "2": 0.5}, ends)
    assert np.allclose(field.values, 1 - x / 8)
    assert field.flux_from("1", np.flatnonzero((x == 8) & (y <= 2))) == pytest.approx(3 * 2 / 8)
    assert field.flux_from("2", np.flatnonzero((x == 8) & (y >= 2))) == pytest.approx(0.5 * 4 / 8)


def test_a_material_without_a_diffusivity_is_named():
    found = mesh_materials(np.array([[1, 2]]))
    regions = Regions(found.names, found.material)
    with pytest.raises(SimulationError, match="no diffusivity of 2"):
        solve_steady(found.mesh, regions, {"1": 1.0}, {0.0: np.array([0])})
    with pytest.raises(SimulationError, match="no given values"):
        solve_steady(found.mesh, regions, {"1": 1.0, "2": 1.0}, {})


def test_the_coefficient_of_an_element_scales_its_matrix():
    found = mesh_materials(np.array([[1, 2], [2, 1]]))
    factors = np.random.default_rng(0).uniform(0.5, 2.0, found.mesh.n_cells)
    whole = assemble(found.mesh, coefficient=factors).stiffness
    single = sum(
        f * assemble(found.mesh, coefficient=1.0 * (np.arange(len(factors)) == k)).stiffness
        for k, f in enumerate(factors[:3])
    )
    rest = assemble(found.mesh, coefficient=np.where(np.arange(len(factors)) < 3, 0, factors))
    assert np.allclose((whole - single - rest.stiffness).toarray(), 0, atol=1e-12)


def test_a_contaminant_spreads_slowly_in_a_dense_material():
    """One of two layers conducts 100 times better: the amount stays, the maximum falls faster."""
    labels = np.ones((16, 16), dtype=np.int64)
    labels[:, 8:] = 2
    found = mesh_materials(labels)
    simulation = Simulation.from_dict({"source": [8.0, 4.0], "diffusivity": 0.01, "time_step": 5})
    factors = np.where(found.material == 0, 1.0, 0.01)
    slow, fast = (
        simulate_diffusion(found.mesh, simulation, steps=(0, 20), diffusivities=d).table
        for d in (None, factors)
    )
    assert abs(fast["amount_relative_error"]).max() < 1e-10
    assert fast["concentration_max"].iloc[-1] < 0.5 * slow["concentration_max"].iloc[-1]
