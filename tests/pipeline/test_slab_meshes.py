"""A mesh in slabs is the mesh in one piece, point for point, and is measured as it is."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from tusqh.antialias.cells import CellSets
from tusqh.contacts.decide import emit_decision
from tusqh.contacts.one_material import VOID
from tusqh.contacts.slab_elements import emit_slab
from tusqh.errors import MeshError
from tusqh.grid import BackgroundGrid
from tusqh.grid.slabs import LEAST, cut
from tusqh.meshes.measure_pieces import measure_pieces
from tusqh.meshes.seams import Piece
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.pipeline.slabs.cells import SlabCells
from tusqh.pipeline.slabs.fractions import Survey
from tusqh.sampling.fractions import VolumeFractions


def random_fractions(seed):
    """Return random fractions, of white or of smooth noise, on a grid in space."""
    rng = np.random.default_rng(seed)
    shape = (int(rng.integers(8, 14)), *map(int, rng.integers(2, 5, 2)))
    values = rng.random([2 * n + 1 for n in shape])
    if seed % 3 == 0:
        values = gaussian_filter(values, 1)
        values = (values - values.min()) / np.ptp(values)
    grid = BackgroundGrid(shape, 0.1 + rng.random(), tuple(rng.normal(size=3)))
    return VolumeFractions.from_values(grid, 4, values)


def mesh_of(cells, grid):
    return emit_decision(cells.decision, grid, "noise", left_out=VOID)[0]


def pieces_of(decision, grid, n_slabs):
    """Return the pieces of a mesh, numbered by the counts of all slabs."""
    parts = [emit_slab(decision, grid, slab, left_out=VOID) for slab in cut(grid, n_slabs)]
    counts = np.array([part.counts for part in parts])
    blocks = counts.sum(axis=0)
    offsets = np.cumsum(blocks) - blocks + np.cumsum(counts, axis=0) - counts
    return [
        Piece(
            part.points, offsets[k][part.block] + part.place, part.cells, part.kind, part.grid_cell
        )
        for k, part in enumerate(parts)
        if len(part.cells)
    ]


def require_same(found, mesh):
    """Raise unless the measurement of pieces is that of the whole mesh."""
    whole = mesh.measurement
    checks = {check.id: check.found for check in found.checks if check.id != "misplaced_points"}
    assert checks == {check.id: check.found for check in whole.checks}
    assert (found.by_euler, found.by_boundary) == (whole.by_euler, whole.by_boundary)
    assert (found.n_cells, found.n_points) == (mesh.n_cells, len(mesh.points))
    assert found.smallest_scaled_jacobian == whole.smallest_scaled_jacobian
    assert found.volume == pytest.approx(whole.volume, rel=1e-12)
    if whole.is_sound:  # Otherwise the boundary need not be closed.
        assert found.enclosed == pytest.approx(whole.enclosed, rel=1e-9)


@pytest.mark.parametrize("seed", range(6))
def test_every_number_of_slabs_gives_the_same_mesh_and_the_same_measurement(seed):
    fractions = random_fractions(seed)
    grid, cells = fractions.grid, CellSets(fractions).at(0.5)
    mesh = mesh_of(cells, grid)
    for n_slabs in range(1, grid.shape[0] // LEAST + 1):
        pieces = pieces_of(cells.decision, grid, n_slabs)
        points = np.full((len(mesh.points), 3), np.nan)
        for piece in pieces:
            points[piece.numbers] = piece.points
        assert np.array_equal(points, mesh.points)
        assert np.array_equal(np.concatenate([p.numbers[p.cells] for p in pieces]), mesh.cells)
        for name in ("kind", "grid_cell"):
            joined = np.concatenate([getattr(piece, name) for piece in pieces])
            assert np.array_equal(joined, getattr(mesh, name))
        found = measure_pieces(pieces, name="noise")
        require_same(found, mesh)
        assert found.is_sound
        assert found.has_topology(cells.predicted)


def damage(mesh, seed):
    """Return points and hexes after some were removed, repeated, torn off or turned."""
    rng = np.random.default_rng(seed)
    cells, points = mesh.cells.copy(), mesh.points.copy()
    if seed % 2:
        cells = cells[np.sort(rng.choice(len(cells), len(cells) // 2, replace=False))]
    if seed % 3 == 1:
        cells = np.concatenate([cells, cells[rng.integers(0, len(cells), 4)]])
    if seed % 4 == 2:
        torn = rng.integers(0, len(cells))
        points = np.concatenate([points, points[cells[torn, 3]][None]])
        cells[torn, 3] = len(points) - 1
    if seed % 5 == 3:
        cells[0] = cells[0][[0, 3, 2, 1, 4, 7, 6, 5]]
    used, corners = np.unique(cells, return_inverse=True)
    places, corners = points[used], corners.reshape(cells.shape)
    return places, corners[np.argsort(places[corners][:, :, 0].mean(axis=1), kind="stable")]


@pytest.mark.parametrize("seed", range(8))
def test_faults_are_counted_in_pieces_as_in_the_whole_mesh(seed):
    fractions = random_fractions(3 * seed)
    mesh = mesh_of(CellSets(fractions).at(0.5), fractions.grid)
    points, cells = damage(mesh, seed)
    whole = VolumeMesh.from_arrays(points, cells)
    for n_pieces in (1, 2):  # Of small grids, a third one would touch the first.
        pieces = []
        for some in np.array_split(cells, n_pieces):
            used, corners = np.unique(some, return_inverse=True)
            zeros = np.zeros(len(some), dtype=np.int64)
            corners = corners.reshape(some.shape).astype(np.int32)
            pieces.append(Piece(points[used], used, corners, zeros.astype(np.int8), zeros))
        require_same(measure_pieces(pieces, name="damaged"), whole)


def two_cubes(**changes):
    """Return two pieces of one cube each, which share a face, with some changes of the second."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
    up = np.array([0.0, 0.0, 1.0])
    cube = np.concatenate([corners, corners + up])
    cell, kind, none = np.arange(8)[None], np.zeros(1, dtype=np.int8), np.zeros(1, dtype=np.int64)
    first = Piece(cube, np.arange(8), cell, kind, none)
    second = {"points": cube + up, "numbers": np.arange(4, 12), "cells": cell}
    return [first, Piece(**(second | changes), kind=kind, grid_cell=none)]


def test_pieces_that_do_not_fit_together_fail_a_check():
    assert measure_pieces(two_cubes(), name="cubes").is_sound
    moved = two_cubes()[1].points.copy()
    moved[0, 0] -= 0.1
    failed = measure_pieces(two_cubes(points=moved), name="cubes").failed
    assert [(check.id, check.found) for check in failed] == [("misplaced_points", 1)]
    failed = measure_pieces(two_cubes(numbers=np.arange(8, 16)), name="cubes").failed
    assert {check.id: check.found for check in failed} == {"repeated_points": 4, "hanging_nodes": 8}
    failed = measure_pieces(two_cubes(numbers=np.arange(5, 13)), name="cubes").failed
    assert "misplaced_points" in {check.id for check in failed}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"numbers": np.arange(8)[::-1]}, "piece 1: cannot be measured: numbers: 7"),
        ({"cells": np.arange(1, 9)[None]}, "piece 1: cannot be measured: indices out of range: 1"),
        ({"cells": np.empty((0, 8), dtype=int)}, "piece 1: cannot be measured: no elements"),
    ],
)
def test_a_piece_that_cannot_be_measured_is_named(changes, message):
    with pytest.raises(MeshError, match=message):
        measure_pieces(two_cubes(**changes), name="cubes")


def test_pieces_that_are_not_neighbours_must_not_share_points():
    first, second = two_cubes()
    apart = two_cubes(points=first.points + 5.0, numbers=np.arange(20, 28))[1]
    with pytest.raises(MeshError, match="pieces that are not neighbours share points"):
        measure_pieces([first, apart, second], name="cubes")
    with pytest.raises(MeshError, match="has no pieces"):
        measure_pieces([], name="cubes")


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("threshold", [0.3, 0.5, 1.0])
def test_one_bit_for_each_place_decides_as_the_fractions_do(seed, threshold):
    fractions = random_fractions(seed)
    fractions.multiples[::3] = 2**20  # Some places that a threshold of 1 keeps.
    expected = CellSets(fractions).at(threshold)
    survey = Survey(fractions.grid, 4, threshold)
    for slab in cut(fractions.grid, 3):
        survey.add(slab, fractions.multiples[slab.rows])
    found = SlabCells.of(survey, "noise")
    assert np.array_equal(found.kept, expected.kept)
    assert found.predicted == expected.predicted
    assert found.raw == CellSets(fractions).topology.betti_at(threshold)
    assert np.array_equal(found.contacts.ball, expected.contacts.ball)
    assert np.array_equal(found.decision.field.sticks, expected.decision.field.sticks)
    assert (found.n_contacts, found.n_overruled) == (expected.n_contacts, 0)
    assert survey.volume() == fractions.volume()
    assert survey.count_ties(threshold) == fractions.count_ties(threshold)
