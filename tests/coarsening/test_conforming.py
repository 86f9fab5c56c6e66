"""Coarse meshes that conform: every pattern of blocks, random meshes, several levels, files."""

from itertools import permutations, product

import meshio
import numpy as np
import pytest
from merged_meshes import full_mesh, random_mesh
from scipy.sparse.linalg import spsolve

from tusqh.coarsening import ConformingMesh, coarsen_conforming
from tusqh.coarsening import transition as transition_module
from tusqh.coarsening.checks import check_conforming, check_same_domain
from tusqh.coarsening.files import read_coarse, write_coarse
from tusqh.coarsening.sheets import CELLS
from tusqh.coarsening.thirds import Level, split_along_axes
from tusqh.coarsening.transition import LEAST, fill_transition
from tusqh.meshes.jacobians import element_volumes, smallest_jacobians
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.simulate.operators import assemble

#: Blocks that may be merged on every side of a pattern.
_AROUND = 3


def tile(patterns):
    """Return blocks in which each pattern of divided ones lies far from the others."""
    n, dim = patterns[0].shape[0], patterns[0].ndim
    width = n + 2 * _AROUND
    divided = np.zeros((width * len(patterns),) + (width,) * (dim - 1), dtype=bool)
    for k, pattern in enumerate(patterns):
        at = (slice(width * k + _AROUND, width * k + _AROUND + n),)
        divided[at + (slice(_AROUND, _AROUND + n),) * (dim - 1)] = pattern
    is_split = np.logical_or.reduce(split_along_axes(divided))
    # The rim of the array counts as divided; nothing of it is close to a pattern.
    inner = (slice(1, -1),) * dim
    is_transition = np.zeros_like(divided)
    is_transition[inner] = (is_split & ~divided)[inner]
    near = np.zeros_like(divided)
    near[inner] = True
    return divided, is_transition & near


def elements_of(divided, is_transition):
    """Return all elements of blocks: cells of divided ones, the transition, and whole blocks."""
    is_whole = ~(divided | is_transition)
    level = Level(1, (0,) * divided.ndim, is_whole, is_transition)
    found = fill_transition(level)
    cells, grid = full_mesh(tuple(CELLS * n for n in divided.shape))
    return found, level, cells, grid


def patterns_up_to_symmetry():
    """Return one pattern of 2 x 2 x 2 blocks of each class under rotations and reflections."""
    seen, chosen = set(), []
    for bits in range(1, 256):
        pattern = np.array([bits >> k & 1 for k in range(8)], dtype=bool).reshape(2, 2, 2)
        same = {
            pattern.transpose(p)[tuple(slice(None, None, s) for s in signs)].tobytes()
            for p in permutations(range(3))
            for signs in product((1, -1), repeat=3)
        }
        if not same & seen:
            seen |= same
            chosen.append(pattern)
    return chosen


def require_good(patterns):
    """Check the transition around patterns, and that it fits the cells and blocks around it."""
    divided, is_transition = tile(patterns)
    found, _, _, _ = elements_of(divided, is_transition)
    scaled = smallest_jacobians(found.points, found.cells).scaled
    assert scaled.min() >= LEAST
    volume = element_volumes(found.points, found.cells).sum()
    assert volume == pytest.approx(is_transition.sum() * CELLS**divided.ndim, rel=1e-12)
    require_facets_fit(found, divided, is_transition)
    return scaled.min()


def require_facets_fit(found, divided, is_transition):
    """Check the facets between the transition and the rest against the lattice, one by one.

    Towards a divided block they are the sides of its cells, towards a whole one its whole side.
    """
    mesh = VolumeMesh.from_arrays(found.points, found.cells)
    corners = mesh.points[mesh.boundary.corners]
    low, high = corners.min(axis=1), corners.max(axis=1)
    extent = np.sort(high - low, axis=1)
    assert (extent[:, 0] == 0).all()  # plane, and across an axis
    is_small = (extent[:, 1:] == 1).all(axis=1)
    is_large = (extent[:, 1:] == CELLS).all(axis=1)
    assert (is_small | is_large).all()
    wanted = {True: 0, False: 0}
    for axis in range(divided.ndim):
        for shift in (-1, 1):
            beside = np.roll(is_transition, shift, axis)
            wanted[True] += int((beside & divided).sum()) * CELLS ** (divided.ndim - 1)
            wanted[False] += int((beside & ~divided & ~is_transition).sum())
    assert int(is_small.sum()) == wanted[True]
    assert int(is_large.sum()) == wanted[False]


def test_every_class_of_patterns_conforms_and_is_good():
    classes = patterns_up_to_symmetry()
    assert len(classes) == 21
    assert require_good(classes) > 0.3


def test_random_patterns_in_the_plane_conform_and_are_good():
    rng = np.random.default_rng(0)
    patterns = [rng.random((6, 6)) < p for p in rng.uniform(0.1, 0.9, 200)]
    assert require_good([p for p in patterns if p.any()]) > 0.5


def test_random_patterns_in_space_conform_and_are_good():
    rng = np.random.default_rng(1)
    require_good([rng.random((3, 3, 3)) < p for p in rng.uniform(0.2, 0.9, 12)])


@pytest.mark.slow
@pytest.mark.parametrize("part", range(5))
def test_all_orientations_of_all_patterns(part):
    all_bits = range(1 + part, 256, 5)
    require_good(
        [np.array([b >> k & 1 for k in range(8)], bool).reshape(2, 2, 2) for b in all_bits]
    )


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_many_random_patterns(seed):
    rng = np.random.default_rng(100 + seed)
    require_good([rng.random((3, 3, 3)) < p for p in rng.uniform(0.1, 0.95, 50)])


@pytest.mark.parametrize(("shape", "seeds"), [((61, 70), 8), ((44, 38, 41), 2)])
def test_the_domain_stays_and_the_boundary_too(shape, seeds):
    n_fewer = 0
    for seed in range(seeds):
        mesh, grid = random_mesh(seed, shape, width=6.0)
        coarse = coarsen_conforming(mesh, grid)
        n_fewer += mesh.n_cells - coarse.mesh.n_cells
        assert all(c.holds for c in check_conforming(coarse) + check_same_domain(coarse, mesh))
        before, after = mesh.boundary.corners, coarse.mesh.boundary.corners
        np.testing.assert_array_equal(coarse.mesh.points[after], mesh.points[before])
    assert n_fewer > 0


@pytest.mark.parametrize("shape", [(50, 45), (37, 36, 38)])
def test_blocks_of_blocks(shape):
    mesh, grid = full_mesh(shape)
    coarse = coarsen_conforming(mesh, grid)
    assert coarse.level.max() >= 2
    assert all(c.holds for c in check_conforming(coarse) + check_same_domain(coarse, mesh))
    sizes = np.ptp(coarse.mesh.points[coarse.mesh.cells], axis=1) / grid.cell_size
    is_block = (coarse.level > 0) & (coarse.mesh.kind == 0)
    np.testing.assert_allclose(
        sizes[is_block], np.repeat(3.0 ** coarse.level[is_block][:, None], len(shape), axis=1)
    )


def test_blocks_with_bad_elements_stay_divided(monkeypatch):
    mesh, grid = random_mesh(3, (40, 36, 40), width=6.0)
    before = coarsen_conforming(mesh, grid)
    limit = before.least_new + 0.02
    monkeypatch.setattr(transition_module, "LEAST", limit)
    coarse = coarsen_conforming(mesh, grid)
    assert coarse.least_new >= limit
    assert all(c.holds for c in check_same_domain(coarse, mesh))
    assert coarse.mesh.n_cells >= before.mesh.n_cells


def test_a_small_mesh_stays_as_it_is():
    mesh, grid = full_mesh((8, 8, 8))
    coarse = coarsen_conforming(mesh, grid)
    assert coarse.mesh.n_cells == mesh.n_cells
    assert coarse.least_new == 1.0


@pytest.mark.parametrize("shape", [(40, 44), (22, 25, 24)])
def test_linear_functions_are_exact(shape):
    mesh, grid = full_mesh(shape)
    coarse = coarsen_conforming(mesh, grid).mesh
    operators = assemble(coarse)
    exact = coarse.points @ np.arange(1.0, len(shape) + 1) - 0.3
    stiffness = operators.stiffness.tocsr()
    fixed = np.zeros(len(exact), dtype=bool)
    fixed[coarse.boundary.corners] = True
    free = ~fixed
    found = exact.copy()
    found[free] = spsolve(
        stiffness[free][:, free].tocsc(), -stiffness[free][:, fixed] @ exact[fixed]
    )
    assert np.abs(found - exact).max() < 1e-10


def test_files_hold_the_mesh(tmp_path):
    mesh, grid = full_mesh((15, 14, 16))
    coarse = coarsen_conforming(mesh, grid)
    write_coarse(tmp_path / "coarse.vtu", coarse)
    again = read_coarse(tmp_path / "coarse.vtu", name="block")
    assert isinstance(again, ConformingMesh)
    assert again.n_uniform == coarse.n_uniform
    np.testing.assert_array_equal(again.level, coarse.level)
    np.testing.assert_array_equal(again.mesh.points, coarse.mesh.points)
    np.testing.assert_array_equal(again.mesh.cells, coarse.mesh.cells)
    for suffix in (".inp", ".mesh", ".bdf"):
        write_coarse(tmp_path / f"coarse{suffix}", coarse)
    read = meshio.read(tmp_path / "coarse.inp")
    assert sum(len(b.data) for b in read.cells if b.type == "hexahedron") == coarse.mesh.n_cells
