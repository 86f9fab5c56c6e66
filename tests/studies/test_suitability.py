"""Pinches, zero modes, mechanisms and leaks of a mesh, each counted in two ways."""

import itertools

import numpy as np
import pandas as pd
import pytest
from fields import decide_votes
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import gudhi_betti

from studies.methods.digital_topology import closed_betti
from studies.methods.raw_mesh import raw_mesh
from studies.methods.stiffness import (
    assemble_stiffness,
    count_kernel,
    count_mechanisms,
    element_matrices,
    estimate_condition,
    label_parts,
)
from studies.methods.whole_cell_repair import repair_by_cells
from studies.suitability import (
    OURS,
    RAW,
    REPAIRED,
    compare_suitability,
    measure_suitability,
    split_iterations,
    summarise_iterations,
    summarise_suitability,
)
from tusqh.antialias.cells import CellSets
from tusqh.antialias.pinches import find_pinches
from tusqh.antialias.resolve import build_mesh
from tusqh.grid import BackgroundGrid
from tusqh.meshes.facets import find_facets
from tusqh.meshes.manifold import find_non_manifold_points
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.sampling.fractions import VolumeFractions, round_fractions
from tusqh.simulate.operators import assemble

SHAPES = {2: (7, 6), 3: (4, 3, 4)}


def grid_of(shape):
    return BackgroundGrid(shape=shape, cell_size=0.5, origin=(0.0,) * len(shape))


def random_cells(seed, dim, density=0.5):
    kept = np.random.default_rng(seed).random(SHAPES[dim]) < density
    kept.flat[0] = True
    return kept


def elasticity(mesh):
    """Return the stiffness of elasticity by another quadrature, with 3 points along every axis."""
    dim, n = mesh.dim, len(mesh.points)
    matrix = np.zeros((n * dim, n * dim))
    places, weights = np.polynomial.legendre.leggauss(3)
    signs = np.array(list(itertools.product((-1, 1), repeat=dim)))
    vtk = [0, 2, 3, 1] if dim == 2 else [0, 4, 6, 2, 1, 5, 7, 3]
    signs = signs[vtk]
    for cell in mesh.cells:
        dofs = (cell[:, None] * dim + np.arange(dim)).ravel()
        for index in itertools.product(range(3), repeat=dim):
            at = places[list(index)]
            factors = (1 + signs * at) / 2
            slope = np.stack(
                [signs[:, k] / 2 * np.delete(factors, k, 1).prod(axis=1) for k in range(dim)], 1
            )
            jacobian = mesh.points[cell].T @ slope
            gradient = slope @ np.linalg.inv(jacobian)
            strain = np.zeros((dim, dim, len(cell), dim))
            for i, j in itertools.product(range(dim), repeat=2):
                strain[i, j, :, i] += gradient[:, j] / 2
                strain[i, j, :, j] += gradient[:, i] / 2
            flat = strain.reshape(dim * dim, -1)
            matrix[np.ix_(dofs, dofs)] += (
                flat.T @ flat * np.linalg.det(jacobian) * weights[list(index)].prod()
            )
    return matrix


def n_zero(matrix):
    values = np.linalg.eigvalsh(matrix)
    return int((values < 1e-9 * values.max()).sum())


@pytest.mark.parametrize("dim", [2, 3])
@given(seed=st.integers(0, 10**6), density=st.floats(0.1, 0.9))
@settings(max_examples=30, deadline=None, derandomize=True)
def test_pinches_are_where_the_mesh_of_the_cells_is_no_manifold(dim, seed, density):
    kept = random_cells(seed, dim, density)
    mesh = raw_mesh(kept, grid_of(kept.shape))
    found = mesh.points[find_non_manifold_points(find_facets(mesh.cells))]
    expected = grid_of(kept.shape).to_points(np.argwhere(find_pinches(kept)))
    assert sorted(map(tuple, found)) == sorted(map(tuple, expected))


@given(seed=st.integers(0, 10**6), density=st.floats(0.1, 0.9))
@settings(max_examples=20, deadline=None, derandomize=True)
def test_raw_cells_have_the_homology_of_their_complex(seed, density):
    kept = random_cells(seed, 3, density)
    assert closed_betti(kept) == gudhi_betti(raw_mesh(kept, grid_of(kept.shape)).cells)


@pytest.mark.parametrize("dim", [2, 3])
@given(seed=st.integers(0, 10**6))
@settings(max_examples=15, deadline=None, derandomize=True)
def test_zero_modes_and_mechanisms_agree_with_the_spectrum(dim, seed):
    kept = random_cells(seed, dim, 0.45)
    mesh = raw_mesh(kept, grid_of(kept.shape))
    stiffness = assemble_stiffness(mesh, element_matrices(mesh)[1])
    n_components = count_kernel(stiffness)
    assert n_components == n_zero(stiffness.toarray())
    n_rigid = dim * (dim + 1) // 2
    assert count_mechanisms(mesh) == n_zero(elasticity(mesh)) - n_rigid * n_components


def test_a_hinge_is_a_mechanism_and_an_edge_in_space_is_one_too():
    assert count_mechanisms(raw_mesh(np.eye(2, dtype=bool), grid_of((2, 2)))) == 1
    by_vertex = np.zeros((2, 2, 2), dtype=bool)
    by_vertex[0, 0, 0] = by_vertex[1, 1, 1] = True
    assert count_mechanisms(raw_mesh(by_vertex, grid_of((2, 2, 2)))) == 3
    by_edge = np.zeros((2, 2, 1), dtype=bool)
    by_edge[0, 0] = by_edge[1, 1] = True
    assert count_mechanisms(raw_mesh(by_edge, grid_of((2, 2, 1)))) == 1


@pytest.mark.parametrize("dim", [2, 3])
def test_matrices_equal_those_of_mfem_on_a_sound_mesh(dim):
    kept = random_cells(3, dim)
    mesh = build_mesh(decide_votes(kept, votes=True), grid_of(kept.shape)).mesh
    operators = assemble(mesh)
    lumped, stiffness = element_matrices(mesh)
    difference = assemble_stiffness(mesh, stiffness) - operators.stiffness
    assert abs(difference).max() < 1e-12 * abs(operators.stiffness).max()
    of_points = np.bincount(mesh.cells.ravel(), lumped.ravel())
    np.testing.assert_allclose(
        of_points, np.asarray(operators.mass.sum(axis=1)).ravel(), rtol=1e-12
    )
    assert measure_suitability(mesh)["manifold"]


@pytest.mark.parametrize("dim", [2, 3])
def test_the_condition_number_agrees_with_all_eigenvalues(dim):
    mesh = raw_mesh(np.ones(SHAPES[dim], dtype=bool), grid_of(SHAPES[dim]))
    stiffness = assemble_stiffness(mesh, element_matrices(mesh)[1])
    scale = 1 / np.sqrt(stiffness.diagonal())
    values = np.linalg.eigvalsh(scale[:, None] * stiffness.toarray() * scale)
    condition, iterations = estimate_condition(stiffness)
    assert condition == pytest.approx(values[-1] / values[1], rel=1e-8)
    assert 0 < iterations < len(values)


def test_rounding_errors_change_the_last_digits_of_the_condition_number_only():
    """The number of iterations may change by one, so it is not in the table that is compared."""
    mesh = raw_mesh(random_cells(1, 3, 0.9), grid_of(SHAPES[3]))
    stiffness = assemble_stiffness(mesh, element_matrices(mesh)[1])
    exact = estimate_condition(stiffness)
    for seed in range(5):
        noisy = stiffness.copy()
        noisy.data *= 1 + 1e-15 * np.random.default_rng(seed).standard_normal(len(noisy.data))
        condition, iterations = estimate_condition(noisy)
        assert condition == pytest.approx(exact[0], rel=1e-8)
        assert abs(iterations - exact[1]) <= 1


@pytest.mark.parametrize("dim", [2, 3])
@given(seed=st.integers(0, 10**6), density=st.floats(0.1, 0.9))
@settings(max_examples=40, deadline=None, derandomize=True)
def test_a_repair_that_ends_leaves_no_pinch_and_counts_its_changes(dim, seed, density):
    fractions = round_fractions(np.random.default_rng(seed).random(SHAPES[dim]))
    kept = fractions >= density
    repair = repair_by_cells(kept, fractions, threshold=density)
    assert repair.has_ended == (not find_pinches(repair.kept).any())
    assert (repair.changes == 0) == (not find_pinches(kept).any())
    assert repair.changes >= (repair.kept != kept).sum()
    again = repair_by_cells(kept, fractions, threshold=density)
    assert (again.kept == repair.kept).all()


def test_heat_leaks_through_a_pinch_and_not_through_nothing():
    hinged = raw_mesh(np.eye(2, dtype=bool), grid_of((2, 2)))
    apart = np.zeros((3, 3), dtype=bool)
    apart[0, 0] = apart[2, 2] = True
    assert label_parts(hinged)[1] == 2
    assert measure_suitability(hinged)["leak"] > 0.04
    assert measure_suitability(raw_mesh(apart, grid_of((3, 3))))["leak"] == 0


def test_the_comparison_of_a_gap():
    """The two blocks meet in a diagonal chain of pinches, whose sub-cells are exterior."""
    n = 8
    values = np.zeros((2 * n + 1, 2 * n + 1))
    kept = np.fromfunction(lambda i, j: (i + j) % n != n - 1, (n, n)) | np.eye(n, dtype=bool)
    values[1::2, 1::2] = np.where(kept, 0.75, 0.125)
    sets = CellSets(VolumeFractions.from_values(grid_of((n, n)), 4, values))
    predicted = sets.at(0.5).predicted
    table = compare_suitability(sets, {"chosen": 0.5}, predicted, name="gap").set_index("scheme")
    assert table["manifold"].tolist() == [False, True, True]
    assert table.loc[RAW, "pinches"] == table.loc[RAW, "non_manifold_points"] > 0
    assert table.loc[OURS, "as_chosen"]
    assert table.loc[OURS, "parts"] == table.loc[OURS, "zero_modes"] == predicted.betti_0
    assert table.loc[REPAIRED, "cells_added"] + table.loc[REPAIRED, "cells_removed"] > 0
    compared, iterations = split_iterations(table.reset_index())
    assert "iterations" not in compared
    summary = summarise_suitability(compared).set_index("scheme")
    assert summary["manifold"].tolist() == [0, 1, 1]
    of_iterations = summarise_iterations(iterations).set_index("scheme")
    assert of_iterations["median"].tolist() == table["iterations"].tolist()
    assert of_iterations.loc[RAW, "median_ratio"] == 1
    assert of_iterations.loc[OURS, "median_ratio"] == pytest.approx(
        table.loc[OURS, "iterations"] / table.loc[RAW, "iterations"], rel=1e-2
    )
    assert summary.loc[OURS, "as_chosen"] == 1
    assert isinstance(summary, pd.DataFrame)


def test_an_empty_mesh_is_measured_too():
    mesh = VolumeMesh.from_arrays(np.zeros((0, 2)), np.zeros((0, 4), dtype=np.int64))
    assert measure_suitability(mesh)["zero_modes"] == 0
