"""With contacts in 3D, every material is a manifold with the predicted Betti numbers."""

import numpy as np
import pytest
from oracles import gudhi_betti, simplicial_betti_by_rank
from random_materials import random_materials

from tusqh.contacts import spatial, sticks
from tusqh.contacts.mesh import mesh_materials
from tusqh.contacts.predict import predict_betti
from tusqh.contacts.spatial_votes import LAYERS
from tusqh.contacts.voxel_fractions import fractions_of_labels
from tusqh.meshes.facets import find_facets
from tusqh.meshes.interfaces import facet_areas
from tusqh.meshes.volume_mesh import SIDE_BALL
from tusqh.topology.filtration import build_filtration

#: The bounds at balls on sides of the grid, and elsewhere.
ON_SIDES, BOUND = 0.39, 1 / np.sqrt(3) - 1e-12


def check_materials(found, case):
    """Compare every material, the void and the solid with the prediction, by two counts."""
    assert found.mesh.measurement.is_sound, case
    assert found.is_as_predicted, case
    assert all(measured.n_non_manifold == 0 for measured in found.measured.values()), case
    bound = np.where(found.mesh.kind == SIDE_BALL, ON_SIDES, BOUND)
    assert (found.mesh.jacobians.scaled >= bound).all(), case
    present = set(found.measured)
    assert {name for name, betti in found.predicted.items() if betti.betti_0} == present


def check_fields(seeds, largest=5):
    n_contacts = 0
    for seed in seeds:
        fractions, thresholds = random_materials(seed, 3, largest)
        found = mesh_materials(fractions, thresholds=thresholds, with_void=True)
        check_materials(found, seed)
        n_contacts += found.n_contacts
    return n_contacts


def test_random_fields():
    assert check_fields(range(150), largest=4) > 2_000


@pytest.mark.slow
def test_3000_random_fields():
    assert check_fields(range(200, 3200)) > 50_000


def test_materials_against_a_simplicial_complex():
    """The barycentric subdivision of the hexes of each material gives the same numbers."""
    for seed in range(4):
        fractions, thresholds = random_materials(seed, 3, 3)
        found = mesh_materials(fractions, thresholds=thresholds)
        for name in found.measured:
            assert gudhi_betti(found.part(name).cells) == found.predicted[name], (seed, name)


@pytest.mark.parametrize("n_fields", [8, pytest.param(300, marks=pytest.mark.slow)])
def test_balls_at_all_vertices_are_manifold_and_as_predicted(monkeypatch, n_fields):
    """Every marked vertex gets elements for its ball, also next to other balls."""

    def judge(vertices, field, tables):
        may_be_good = field.has_ball[vertices] | ~field.marked[vertices]
        return may_be_good & sticks.judge(vertices, field, tables)

    monkeypatch.setattr(spatial, "judge", judge)
    n_balls = 0
    for seed in range(n_fields):
        fractions, thresholds = random_materials(seed, 3, 4)
        t = np.full(len(fractions.names), 2**20)
        labels = np.pad(fractions.label_cells(t), LAYERS, constant_values=fractions.void)
        n_balls += spatial.decide_sticks(fractions, labels, t).field.has_ball.sum()
        check_materials(mesh_materials(fractions, thresholds=thresholds, with_void=True), seed)
    assert n_balls > 100


def simplices_of(labels, contacts, material):
    """Return the paper's complex of a material: its cells and the contacts decided for it."""
    values = np.zeros(tuple(2 * n + 1 for n in labels.shape))
    values[1::2, 1::2, 1::2] = labels == material
    for cells, decided in (
        (contacts.edge_cells, contacts.edge_material),
        (contacts.vertex_cells, contacts.ball),
    ):
        places = 2 * np.stack(np.unravel_index(cells, labels.shape)).mean(axis=2) + 1
        values[tuple(places.astype(int))] = decided == material
    filtration = build_filtration(values)
    level = np.flatnonzero(filtration.values == 1)
    return [s[np.isin(s, level).all(axis=1)] for s in filtration.simplices]


def test_the_prediction_is_the_papers_complex():
    """Compare with the ranks over GF(2) of the listed simplices, for every material."""
    n_compared = 0
    for seed in range(12):
        fractions, _ = random_materials(seed, 3, 3)
        t = np.full(len(fractions.names), 2**20)
        labels = np.pad(fractions.label_cells(t), LAYERS, constant_values=fractions.void)
        contacts = spatial.decide_sticks(fractions, labels, t).contacts
        predicted = predict_betti(labels, contacts, len(fractions.names))
        for k in np.unique(labels)[:-1]:
            by_rank = simplicial_betti_by_rank(simplices_of(labels, contacts, k))
            assert tuple([*by_rank, 0, 0][:3]) == tuple(predicted[k]), (seed, k)
            n_compared += 1
    assert n_compared > 25


def test_materials_fill_the_box_and_interfaces_have_two_equal_sides():
    for seed in range(6):
        fractions, _ = random_materials(seed, 3, 4)
        found = mesh_materials(fractions, with_void=True)
        box = np.prod([n + 2 for n in fractions.grid.shape])
        volumes = [found.part(name).volumes.sum() for name in found.measured]
        assert np.isclose(sum(volumes), box, rtol=1e-12)
        for (a, b), side in found.interfaces.items():
            # Sets of points of the facets, from each material's own boundary.
            other = found.interfaces.get((b, a))
            if other is None:
                assert b == "void"  # The side of the outermost layer.
                continue
            assert {*map(frozenset, side.facets.tolist())} == {
                *map(frozenset, other.facets.tolist())
            }
            areas = [facet_areas(found.mesh.points, s.facets).sum() for s in (side, other)]
            assert np.isclose(*areas, rtol=1e-12)


def test_sides_of_the_grid_stay_plane():
    """No element leaves the box, and elements of its cells fill it, also with contacts on sides."""
    n_on_sides = n_of_balls = 0
    for seed in (3, 8, 9, 13, 15, 20):
        fractions, _ = random_materials(seed, 3, 4)
        shape = np.array(fractions.grid.shape)
        found = mesh_materials(fractions, with_void=True)
        inside = found.mesh.grid_cell >= 0
        assert np.isclose(found.mesh.volumes[inside].sum(), shape.prod(), rtol=1e-12)
        points = found.mesh.points[found.mesh.cells[inside]]
        assert points.min() >= 0
        assert (points <= shape).all()
        assert (found.material[~inside] == len(found.names) - 1).all()
        facets = find_facets(found.mesh.cells[inside])
        is_single = np.bincount(facets.unique)[facets.unique] == 1
        corners = found.mesh.points[facets.corners[is_single]]
        on_side = (corners == 0).all(axis=1) | (corners == shape).all(axis=1)
        assert on_side.any(axis=1).all()
        n_on_sides += len(corners) - 2 * sum(shape.prod() // n for n in shape)
        n_of_balls += (found.mesh.kind == SIDE_BALL).sum()
    assert n_on_sides > 100
    assert n_of_balls > 100


def test_one_voxel_a_cell_follows_the_voxels():
    """Without pinches the mesh consists of the voxels, and the volume of each label is exact."""
    image = np.ones((4, 4, 4), dtype=np.uint8)
    image[1:3, 1:3, 1:] = 7
    found = mesh_materials(fractions_of_labels(image, names={7: "core"}))
    assert found.mesh.n_cells == 64
    assert found.part("core").volumes.sum() == 12
    assert found.predicted["core"] == (1, 0, 0)
    assert found.predicted["1"] == (1, 0, 0)
    assert found.interfaces["core", "1"].facets.shape == (28, 4)


def test_more_materials_than_fit_in_eight_bits_are_decided_alike():
    labels = np.random.default_rng(1).integers(0, 3, (5, 4, 4))
    few = mesh_materials(labels, with_void=True)
    more = np.concatenate([labels, np.full((2, 4, 4), 3), np.arange(4, 132).reshape(8, 4, 4)])
    many = mesh_materials(more, with_void=True)
    check_materials(many, "many")
    assert len(many.names) > 2**7 > len(few.names)
    within = [
        (found.mesh.grid_cell >= 0) & (found.mesh.grid_cell < 4 * 4 * 4) for found in (few, many)
    ]
    np.testing.assert_array_equal(few.mesh.kind[within[0]], many.mesh.kind[within[1]])
    material = np.where(few.material == 3, len(many.names) - 1, few.material)
    np.testing.assert_array_equal(material[within[0]], many.material[within[1]])
