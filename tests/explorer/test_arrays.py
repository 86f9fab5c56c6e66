"""The arrays of the page agree with the tables and with the library."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from subjects import box_of, keys_of, make_subject, noise

import tusqh
from tusqh.antialias.cells import CellSets
from tusqh.explorer import arrays
from tusqh.explorer.distances import NONE, as_colours, boundary_distances
from tusqh.geometry.image import Image
from tusqh.geometry.outline import Outline
from tusqh.grid import BackgroundGrid
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.settings.policy import Policy
from tusqh.topology.clamping import FULL

POLICIES = {
    2: {"components": {"min_cells": 3}, "holes": {"min_cells": 2}},
    3: {"components": {"min_cells": 4}, "voids": {"min_cells": 2}},
}
SHAPES = {2: (9, 7), 3: (5, 4, 6)}


@pytest.fixture(scope="module", params=[2, 3], ids=["plane", "space"])
def subject(request):
    fractions = noise(np.random.default_rng(request.param), SHAPES[request.param])
    return make_subject(fractions, POLICIES[request.param])


def sets_of(subject):
    return CellSets(subject.fractions, Policy.from_dict(subject.selection.policy))


@given(st.integers(0, 2**32 - 1), st.sampled_from([2, 3]), st.floats(1e-6, 1.0))
@settings(max_examples=60, deadline=None)
def test_ranks_tell_the_kept_cells_at_any_threshold(seed, dim, threshold):
    fractions = noise(np.random.default_rng(seed), SHAPES[dim])
    found = arrays.field_arrays(fractions)
    kept = found["levels"][found["rank"]] >= threshold * FULL
    np.testing.assert_array_equal(kept.reshape(fractions.grid.shape), fractions.cells >= threshold)


def test_plateaus_are_those_of_both_tables(subject):
    found = arrays.plateau_arrays(sets_of(subject), subject.curves, subject.topologies)
    upper = found["upper"] / FULL
    assert (np.diff(upper) < 0).all()
    assert set(subject.curves["upper"]) <= set(upper)
    assert set(subject.topologies["upper"]) <= set(upper)
    for p, threshold in enumerate(upper):
        for kind, table, prefix in (
            ("raw", subject.curves, "betti_"),
            ("mesh", subject.topologies, "betti_"),
        ):
            row = table[(table["lower"] < threshold) & (threshold <= table["upper"])].iloc[0]
            for k in range(3):
                assert found[f"{kind}_{k}"][p] == row[f"{prefix}{k}"]


def test_plateaus_that_nobody_examined_say_so(subject):
    some = subject.topologies.iloc[1::2]
    found = arrays.plateau_arrays(sets_of(subject), subject.curves, some)
    examined = set(keys_of(some["upper"]))
    for key, betti in zip(found["upper"].tolist(), found["mesh_0"].tolist(), strict=True):
        inside = ((keys_of(some["lower"]) < key) & (key <= keys_of(some["upper"]))).any()
        assert (betti >= 0) == inside
    assert examined <= set(found["upper"].tolist())


def test_toggles_lead_to_the_cells_of_every_plateau(subject):
    sets = sets_of(subject)
    found = arrays.plateau_arrays(sets, subject.curves, subject.topologies)
    is_special = np.zeros(subject.fractions.grid.n_cells, dtype=bool)
    n_special = 0
    for p, upper in enumerate(found["upper"] / FULL):
        first, last = found["toggles_from"][p : p + 2]
        is_special[found["toggles"][first:last]] ^= True
        n_special += is_special.sum()
        kept = sets.at(upper).kept.ravel()
        by_fraction = subject.fractions.cells.ravel() >= upper
        np.testing.assert_array_equal(by_fraction ^ is_special, kept)
    assert n_special > 0  # Otherwise the test checks nothing.


def test_pairs_have_their_places_back(subject):
    grid = subject.fractions.grid
    found = arrays.pair_arrays(subject.diagram, grid)
    assert (np.diff(found["birth"].astype(int) - found["death"].astype(int)) <= 0).all()
    shape = tuple(2 * n + 1 for n in grid.shape)
    points = {}
    for event in ("birth", "death"):
        place = found[f"{event}_place"]
        doubled = np.stack(np.unravel_index(np.maximum(place, 0), shape), axis=1)
        points[event] = np.where(place[:, None] >= 0, grid.to_points(doubled / 2), np.nan)
    ours = np.column_stack(
        [found["dimension"], found["birth"] / FULL, found["death"] / FULL, *points.values()]
    )
    columns = ["dimension", "birth", "death"]
    columns += [f"{event}_{axis}" for event in points for axis in "xyz"[: grid.dim]]
    theirs = subject.diagram[columns].to_numpy(dtype=float)
    order = [np.lexsort(np.nan_to_num(rows, nan=-1e9).T) for rows in (ours, theirs)]
    np.testing.assert_allclose(ours[order[0]], theirs[order[1]], atol=1e-12)


def decode_mesh(found, dim):
    """Return points, facets and their elements as the page understands them."""
    corners = found["corners"].reshape(-1, 4).astype(np.int64)
    corners[:, 0] = np.cumsum(corners[:, 0])
    corners[:, 1:] += corners[:, :1]
    first = np.cumsum(found["first"])
    points = found["points"].reshape(-1, dim)
    return points, corners, first, first + found["second"], found["second"] != 0


def test_the_mesh_comes_back_from_its_facets(subject):
    grid, mesh = subject.fractions.grid, subject.mesh
    found = arrays.mesh_arrays(mesh, grid)
    points, corners, first, second, is_inner = decode_mesh(found, mesh.dim)
    np.testing.assert_allclose(grid.to_points(points), mesh.points, atol=1e-5)
    np.testing.assert_array_equal(found["kind"], mesh.kind)
    np.testing.assert_array_equal(np.cumsum(found["cell"]), np.maximum(mesh.grid_cell, 0))
    if mesh.dim == 2:
        np.testing.assert_array_equal(corners, mesh.cells)
        return
    boundary = mesh.boundary
    ours = {
        (*sorted(c), e)
        for c, e in zip(corners[~is_inner].tolist(), first[~is_inner].tolist(), strict=True)
    }
    theirs = {
        (*sorted(c), e)
        for c, e in zip(boundary.corners.tolist(), boundary.element.tolist(), strict=True)
    }
    assert ours == theirs
    assert len(corners) == (6 * mesh.n_cells + len(boundary.corners)) // 2
    for c, a, b in zip(corners[is_inner], first[is_inner], second[is_inner], strict=True):
        assert set(c) <= set(mesh.cells[a]) & set(mesh.cells[b])
    # Every facet faces out of its first element.
    places = mesh.points[corners]
    normals = np.cross(places[:, 2] - places[:, 0], places[:, 3] - places[:, 1])
    away = places.mean(axis=1) - mesh.points[mesh.cells[first]].mean(axis=1)
    assert ((normals * away).sum(axis=1) > 0).all()


def test_large_meshes_are_shown_by_their_boundary(subject, monkeypatch):
    monkeypatch.setattr(arrays, "CUT_ELEMENTS", 1)
    found = arrays.mesh_arrays(subject.mesh, subject.fractions.grid)
    n = subject.mesh.n_cells if subject.mesh.dim == 2 else len(subject.mesh.boundary.corners)
    assert len(found["first"]) == n
    assert not found["second"].any()


def test_geometry_is_rounded_by_no_more_than_a_step(subject, monkeypatch):
    grid = subject.fractions.grid
    geometry = box_of(grid)
    found = arrays.geometry_arrays(geometry, grid)
    *lower, side = found["box"].tolist()
    points = np.array(lower) + side * found["points"].reshape(-1, grid.dim) / 65535
    pieces = geometry.segments if grid.dim == 2 else geometry.triangles
    shown = grid.to_points(points)[found["pieces"].reshape(pieces.shape)]
    np.testing.assert_allclose(shown, geometry.points[pieces], atol=side * grid.cell_size / 65535)
    monkeypatch.setattr(arrays, "GEOMETRY_PIECES", 1)
    assert arrays.geometry_arrays(geometry, grid)["pieces"].size == 0


def test_images_have_no_surface_to_show(subject):
    image = Image(np.ones((2, 2, 2)))
    assert arrays.geometry_arrays(image, subject.fractions.grid)["pieces"].size == 0


def test_facets_have_their_distance_from_the_geometry():
    """A ball of radius 1 around a mesh whose points lie at other, known distances from it."""
    turns = np.linspace(0, 2 * np.pi, 2000, endpoint=False)
    ring = np.column_stack([np.cos(turns), np.sin(turns)])
    outline = Outline(
        ring, np.column_stack([np.arange(2000), np.roll(np.arange(2000), -1)]), "ring"
    )
    grid = BackgroundGrid(shape=(30, 30), cell_size=0.1, origin=(-1.5, -1.5))
    corners = np.array([[0.9, 0.0], [0.0, 0.9], [-0.9, 0.0], [0.0, -0.97]])
    mesh = VolumeMesh.from_arrays(corners, np.arange(4)[None])
    found = boundary_distances(mesh, outline, grid)
    middles = np.linalg.norm((corners + np.roll(corners, -1, axis=0)) / 2, axis=1)
    assert found == pytest.approx((1 - middles) / 0.1, abs=1e-3)
    shown = arrays.mesh_arrays(mesh, grid, distances=np.array([0.01, 0.1, np.nan, 0.05]))
    assert shown["distance"].tolist() == [127]
    nothing = arrays.mesh_arrays(mesh, grid, distances=np.full(4, np.nan))
    assert nothing["distance"].tolist() == [NONE]


def test_facets_where_a_window_cuts_have_no_distance():
    outline = Outline(np.array([[1.0, 0.0], [1.0, 2.0]]), np.array([[0, 1]]), "line")
    grid = BackgroundGrid(shape=(2, 2), cell_size=1.0, origin=(0.0, 0.0))
    points = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 2.0], [0.0, 2.0]])
    mesh = VolumeMesh.from_arrays(points, np.arange(4)[None])
    found = boundary_distances(mesh, outline, grid)
    on_line = (points[mesh.boundary.corners][..., 0] == 1).all(axis=1)
    assert np.isnan(found).tolist() == (~on_line).tolist()
    assert found[on_line] == pytest.approx(0)


def test_each_facet_of_hexes_keeps_its_own_distance():
    mesh = tusqh.mesh(np.ones((2, 1, 1)), cells=2, threshold=0.5).mesh
    grid = BackgroundGrid(shape=(2, 1, 1), cell_size=1.0, origin=(0.0, 0.0, 0.0))
    given = np.arange(len(mesh.boundary.corners)) / 100
    shown = arrays.mesh_arrays(mesh, grid, distances=given)
    others = np.pad(shown["corners"][:, 1:], ((0, 0), (1, 0)))
    corners = np.cumsum(shown["corners"][:, :1], axis=0) + others
    facets = np.sort(mesh.boundary.corners, axis=1).tolist()
    of_facet = dict(zip(map(tuple, facets), as_colours(given).tolist(), strict=True))
    for row, value in zip(corners.tolist(), shown["distance"].tolist(), strict=True):
        assert value == of_facet.get(tuple(sorted(row)), NONE)
