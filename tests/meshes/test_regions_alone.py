"""Regions measured in one pass have the numbers of meshes of their own; so have broken ones."""

import numpy as np
import pytest

from tusqh.contacts import fractions_of_labels, mesh_materials
from tusqh.meshes.interfaces import find_interfaces, find_junctions
from tusqh.meshes.measure_regions import RegionMeasurement, measure_regions
from tusqh.meshes.volume_mesh import VolumeMesh


def voxels(labels):
    """Return the cells of an image as elements, with contacts as they are, and their labels."""
    shape = tuple(n + 1 for n in labels.shape)
    corner = np.argwhere(np.ones(labels.shape, dtype=bool))
    steps = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])[:, : labels.ndim]
    if labels.ndim == 3:
        steps = np.concatenate([steps, steps + np.array([0, 0, 1])])
    corners = np.moveaxis(corner[:, None] + steps, -1, 0)
    points = np.argwhere(np.ones(shape, dtype=bool)).astype(float)
    return VolumeMesh.from_arrays(
        points, np.ravel_multi_index(tuple(corners), shape)
    ), labels.ravel()


def part(mesh, chosen):
    used, cells = np.unique(mesh.cells[chosen], return_inverse=True)
    return VolumeMesh.from_arrays(mesh.points[used], cells.reshape(-1, mesh.cells.shape[1]))


@pytest.mark.parametrize("dim", [2, 3])
def test_regions_are_measured_as_meshes_of_their_own(dim):
    """Most of these parts are not manifold, so the two methods differ; each must agree."""
    rng = np.random.default_rng(dim)
    n_bad = 0
    for _ in range(12):
        mesh, labels = voxels(rng.integers(0, 3, (5, 4, 3)[:dim]))
        for k, found in enumerate(measure_regions(mesh, labels, 3)):
            alone = RegionMeasurement.of(part(mesh, labels == k).measurement)
            assert found == pytest.approx(alone) if alone.n_cells == 0 else found == alone
            n_bad += found.n_non_manifold > 0
    assert n_bad > 5


def test_every_material_of_a_resolved_mesh():
    rng = np.random.default_rng(8)
    found = mesh_materials(rng.integers(0, 4, (5, 5, 5)))
    for name, measured in found.measured.items():
        alone = RegionMeasurement.of(found.part(name).measurement)
        assert measured.volume == pytest.approx(alone.volume)
        assert measured.by_euler == alone.by_euler == measured.by_boundary
        assert measured.n_non_manifold == 0


def test_interfaces_and_junctions_of_four_cells():
    mesh, labels = voxels(np.array([[0, 1], [2, 2]]))
    names = ("a", "b", "c", "void")
    pairs = find_interfaces(mesh, labels, names)
    sizes = {f"{x}|{y}": len(side.facets) for (x, y), side in pairs.items()}
    assert sizes == {
        **{"a|b": 1, "a|c": 1, "a|void": 2, "b|a": 1, "b|c": 1, "b|void": 2},
        **{"c|a": 1, "c|b": 1, "c|void": 4},
    }
    for side in pairs.values():
        corners = mesh.cells[side.elements]
        ends = np.stack([side.local, (side.local + 1) % 4], axis=1)
        assert np.array_equal(np.take_along_axis(corners, ends, axis=1), side.facets)
    junctions = find_junctions(mesh, labels, names)
    at = {"".join(three): mesh.points[points].tolist() for three, points in junctions.items()}
    assert at == {
        "abc": [[1, 1]],
        "abvoid": [[0, 1]],
        "acvoid": [[1, 0]],
        "bcvoid": [[1, 2]],
    }


def test_junctions_of_four_materials_belong_to_four_sets():
    image = np.arange(4).reshape(2, 2, 1).repeat(3, axis=2)
    mesh, labels = voxels(image)
    junctions = find_junctions(mesh, labels, ("a", "b", "c", "d", "void"))
    inner = [points for three, points in junctions.items() if "void" not in three]
    assert len(inner) == 4
    assert all(np.array_equal(points, inner[0]) for points in inner)
    assert len(inner[0]) == 4


def test_labels_that_fill_a_box_fill_it():
    """Volumes add up to the box, and areas are the same from both sides."""
    rng = np.random.default_rng(1)
    image = rng.integers(0, 3, (6, 6)).repeat(2, axis=0).repeat(2, axis=1)
    found = mesh_materials(fractions_of_labels(image, voxels_per_cell=2))
    assert sum(m.volume for m in found.measured.values()) == pytest.approx(144)
