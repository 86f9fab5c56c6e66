"""Coarse meshes: their blocks, their hanging vertices, and the cells for which they stand."""

import numpy as np
import pytest
from merged_meshes import full_mesh, random_mesh
from scipy import ndimage
from scipy.sparse.linalg import spsolve

from tusqh.coarsening import coarsen
from tusqh.coarsening.blocks import find_blocks, find_plain_cells
from tusqh.coarsening.checks import check_coarse, level_of_cells
from tusqh.coarsening.coarse_mesh import CoarseMesh
from tusqh.coarsening.files import read_coarse, write_coarse
from tusqh.coarsening.mfem_text import to_mfem
from tusqh.errors import MeshError
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.simulate.operators import assemble


def brute_force_levels(is_plain, layers):
    """Return the level of each cell by asking every block for its neighbours, one by one."""
    level = np.where(is_plain, 0, -1)
    allowed = is_plain.copy()
    for _ in range(layers):
        allowed = ndimage.binary_erosion(allowed, np.ones(3 * np.ones(allowed.ndim, dtype=int)))
    size = 1
    while min(allowed.shape) >= 1:
        shape = [n // 2 for n in allowed.shape]
        merged = np.zeros(shape, dtype=bool)
        for place in np.ndindex(*shape):
            children = tuple(slice(2 * p, 2 * p + 2) for p in place)
            merged[place] = allowed[children].all()
        if not merged.any():
            return level
        size *= 2
        for place in np.argwhere(merged):
            level[tuple(slice(p * size, (p + 1) * size) for p in place)] = size.bit_length() - 1
        allowed = ndimage.binary_erosion(merged, np.ones(3 * np.ones(merged.ndim, dtype=int)))
    return level


def in_canonical_order(mesh):
    """Return the corner positions of all elements, sorted by element."""
    corners = mesh.points[mesh.cells].reshape(mesh.n_cells, -1).round(9)
    return corners[np.lexsort(corners.T)]


@pytest.mark.parametrize(("shape", "seeds"), [((37, 30), 12), ((19, 16, 22), 6)])
def test_a_coarse_mesh_stands_for_the_mesh_it_was_made_from(shape, seeds):
    merged = 0
    for seed in range(seeds):
        mesh, grid = random_mesh(seed, shape)
        coarse = coarsen(mesh, grid)
        merged += coarse.n_merged
        assert all(check.holds for check in check_coarse(coarse))
        uniform = coarse.uniform
        assert coarse.n_uniform == uniform.n_cells == mesh.n_cells
        assert np.array_equal(in_canonical_order(uniform), in_canonical_order(mesh))
        assert uniform.measurement.is_sound
        assert uniform.measurement.by_euler == mesh.measurement.by_euler
        assert len(uniform.facets.boundary) == len(mesh.facets.boundary)
        assert np.array_equal(uniform.points[: len(coarse.mesh.points)], coarse.mesh.points)
    assert merged > 0


@pytest.mark.parametrize("layers", [1, 2])
@pytest.mark.parametrize("shape", [(41, 38), (23, 18, 20)])
def test_levels_are_those_of_a_search_block_by_block(shape, layers):
    for seed in range(3):
        mesh, grid = random_mesh(100 + seed, shape)
        coarse = coarsen(mesh, grid, layers=layers)
        is_plain = find_plain_cells(mesh, grid) >= 0
        expected = brute_force_levels(is_plain, layers)
        found = level_of_cells(coarse)
        assert np.array_equal(np.maximum(found, 0), np.maximum(expected, 0))
    mesh, grid = full_mesh(shape)
    found = level_of_cells(coarsen(mesh, grid, layers=layers))
    expected = brute_force_levels(np.ones(shape, dtype=bool), layers)
    assert np.array_equal(found, expected)
    assert found.max() >= 2


@pytest.mark.parametrize("shape", [(40, 40), (20, 20, 20)])
def test_hanging_vertices_are_those_inside_sides_edges_and_faces(shape):
    """The vertices are found again by searching all vertices of the mesh on every block."""
    mesh, grid = full_mesh(shape)
    coarse = coarsen(mesh, grid)
    at = ((coarse.mesh.points - grid.origin) / grid.cell_size).round().astype(int)
    hangs = np.zeros(len(at), dtype=bool)
    for start, size in zip(coarse.starts, coarse.sizes, strict=True):
        from_start = at - start
        touches = ((from_start >= 0) & (from_start <= size)).all(axis=1)
        inner = ((from_start > 0) & (from_start < size)).sum(axis=1)
        hangs |= touches & (inner > 0)
    assert np.array_equal(np.flatnonzero(hangs), coarse.hanging[:, 0])
    vertex, first, second = coarse.hanging.T
    assert np.array_equal(2 * at[vertex], at[first] + at[second])


@pytest.mark.parametrize("shape", [(36, 31), (20, 17, 18)])
def test_mfem_reproduces_linear_functions(shape):
    """The patch test: values at hanging vertices follow from the elements around them."""
    for mesh, grid in (random_mesh(7, shape), full_mesh(shape)):
        coarse = coarsen(mesh, grid)
        native = to_mfem(coarse)
        assert native.Nonconforming()
        assert native.GetNE() == coarse.mesh.n_cells
        assert native.GetNBE() == len(mesh.facets.boundary)
        operators = assemble(coarse)
        n_unknowns = len(coarse.mesh.points) - len(coarse.hanging)
        assert operators.stiffness.shape == (n_unknowns, n_unknowns)
        exact = 1 + operators.nodes @ np.arange(1, len(shape) + 1) * 0.7
        boundary = mesh.points[np.unique(mesh.facets.boundary)]
        is_fixed = find_rows(operators.nodes, boundary)
        assert is_fixed.sum() == len(boundary)
        free = ~is_fixed
        right = -operators.stiffness[free][:, is_fixed] @ exact[is_fixed]
        found = spsolve(operators.stiffness[free][:, free].tocsc(), right)
        assert np.abs(found - exact[free]).max() < 1e-10 * np.abs(exact).max()
        volume = np.ones(n_unknowns) @ operators.mass @ np.ones(n_unknowns)
        assert volume == pytest.approx(mesh.measurement.volume, rel=1e-12)


def find_rows(rows, among):
    """Return which rows are among others."""
    known = {row.tobytes() for row in np.ascontiguousarray(among)}
    return np.array([row.tobytes() in known for row in np.ascontiguousarray(rows)])


def test_a_file_holds_the_same_mesh(tmp_path):
    mesh, grid = random_mesh(3, (20, 18, 22))
    coarse = coarsen(mesh, grid)
    write_coarse(tmp_path / "coarse.vtu", coarse)
    again = read_coarse(tmp_path / "coarse.vtu")
    assert again.grid == grid
    for name in ("level", "hanging", "starts", "sizes"):
        assert np.array_equal(getattr(again, name), getattr(coarse, name))
    assert np.array_equal(in_canonical_order(again.uniform), in_canonical_order(mesh))


def test_other_formats_are_refused(tmp_path):
    mesh, grid = full_mesh((10, 10))
    with pytest.raises(MeshError, match="cannot hold the hanging vertices") as caught:
        write_coarse(tmp_path / "coarse.msh", coarsen(mesh, grid))
    assert "write .mesh for MFEM" in str(caught.value)
    assert not list(tmp_path.iterdir())


def test_a_mesh_without_an_inside_stays(tmp_path):
    mesh, grid = full_mesh((3, 3, 3))
    coarse = coarsen(mesh, grid)
    assert coarse.n_merged == 0
    assert len(coarse.hanging) == 0
    assert np.array_equal(coarse.mesh.cells, mesh.cells)
    assert to_mfem(coarse).GetNE() == 27


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda c: (c.mesh.points + 0.01, c.level, c.mesh.grid_cell), "not where their grid cells"),
        (lambda c: (c.mesh.points, np.minimum(c.level * 3, 5), c.mesh.grid_cell), "outside|where"),
        (lambda c: (c.mesh.points, c.level, repeated(c)), "in two blocks"),
    ],
)
def test_blocks_that_are_not_whole_cells_are_an_error(change, message):
    mesh, grid = full_mesh((20, 20))
    coarse = coarsen(mesh, grid)
    points, level, grid_cell = change(coarse)
    wrong = VolumeMesh(points, coarse.mesh.cells, coarse.mesh.kind, grid_cell, "block")
    with pytest.raises(MeshError, match=message):
        _ = CoarseMesh(wrong, level.astype(np.int8), grid).uniform


def repeated(coarse):
    """Return grid cells in which two blocks of a level have the same place."""
    cells = coarse.mesh.grid_cell.copy()
    first, second = np.flatnonzero(coarse.level == 1)[:2]
    cells[second] = cells[first]
    return cells


def test_blocks_beside_much_larger_ones_fail_the_check():
    mesh, grid = full_mesh((20, 20))
    levels = find_blocks(np.ones((20, 20), dtype=bool))
    assert len(levels) >= 2
    coarse = coarsen(mesh, grid)
    alone = VolumeMesh(
        grid.to_points(np.array([[4, 4], [12, 4], [12, 12], [4, 12]])),
        np.array([[0, 1, 2, 3]], dtype=np.int32),
        np.zeros(1, dtype=np.int8),
        np.array([4 * 20 + 4], dtype=np.int32),
        "alone",
    )
    checks = {c.id: c for c in check_coarse(CoarseMesh(alone, np.array([3], np.int8), grid))}
    assert not checks["coarse_sizes"].holds
    assert all(check.holds for check in check_coarse(coarse))
