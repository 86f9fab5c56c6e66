"""Walls have their known thickness, and walls thinner than a cell cause a warning."""

import numpy as np
import pytest
import trimesh

import tusqh
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup import Soup
from tusqh.quality.thickness import measure_thickness


def solid(*meshes):
    return Soup.from_parts([(np.asarray(m.vertices), np.asarray(m.faces)) for m in meshes])


def box(low, high):
    return trimesh.creation.box(bounds=[low, high])


def inverted(mesh):
    mesh.invert()
    return mesh


def shell(outer, inner):
    return solid(
        trimesh.creation.icosphere(4, outer), inverted(trimesh.creation.icosphere(4, inner))
    )


@pytest.mark.parametrize("seed", range(5))
def test_a_turned_plate_has_its_thickness_and_its_material(seed):
    rng = np.random.default_rng(seed)
    sides = np.array([10.0, 8.0, rng.uniform(0.1, 0.5)])
    plate = box([0, 0, 0], sides)
    plate.apply_transform(trimesh.transformations.random_rotation_matrix(rng.random(3)))
    thickness = measure_thickness(solid(plate), seed=seed)
    faces = 2 * sides[0] * sides[1]
    assert thickness.share_below(1.01 * sides[2]) == pytest.approx(faces / plate.area, abs=0.06)
    assert thickness.share_below(0.99 * sides[2]) == 0
    assert thickness.material_below(1.01 * sides[2]) == pytest.approx(plate.volume, rel=0.06)
    assert thickness.resolving == pytest.approx(sides[2] / 2)


def test_a_shell_has_the_thickness_of_its_wall_on_both_sides():
    lengths = measure_thickness(shell(1.0, 0.9)).lengths
    assert lengths.min() > 0.09
    assert lengths.max() < 0.105


def test_facets_inside_the_material_are_no_surface():
    overlapping = solid(box([0, 0, 0], [2, 1, 1]), box([1.9, 0, 0], [4, 1, 1]))
    lengths = measure_thickness(overlapping).lengths
    assert lengths.min() > 0.99
    touching = solid(box([0, 0, 0], [2, 1, 1]), box([2, 0, 0], [4, 1, 1]))
    assert measure_thickness(touching).lengths.min() > 0.99


def test_outside_the_walls_are_the_gaps():
    gap = solid(box([0, 0, 0], [2, 2, 2]), box([2.1, 0, 0], [4, 2, 2]))
    lengths = measure_thickness(gap, is_outside=True).lengths
    assert np.isinf(lengths).any()
    assert lengths[np.isfinite(lengths)] == pytest.approx(0.1)
    assert measure_thickness(gap).lengths.min() > 1.8


def test_in_the_plane_a_strip_has_its_width():
    strip = Outline.from_chains([np.array([[0, 0], [9.0, 0], [9, 0.3], [0, 0.3], [0, 0]])])
    assert np.median(measure_thickness(strip).lengths) == pytest.approx(0.3)
    window = ((0.0, -1.0), (9.0, 0.1))
    below = measure_thickness(strip, window=window)
    assert below.surface == pytest.approx(9.2, rel=0.1)


def warnings(result):
    table = result.report.verdict
    return table[table["holds"] == "warning"].set_index("id")


def test_a_thin_enclosure_is_warned_of_although_its_volume_is_right():
    geometry = shell(1.0, 0.93)
    result = tusqh.mesh((geometry.points, geometry.triangles), cells=20, volume_tolerance=0.49)
    row = warnings(result).loc["thin_walls"]
    assert row["found"].startswith("100 % of the surface bounds walls thinner than a cell of 0.1")
    resolving = float(row["remedy"].split("`--cell-size ")[1].split("`")[0])
    assert resolving == pytest.approx(0.035, rel=0.05)


def test_a_block_with_a_thin_fin_is_warned_of_and_without_it_not():
    block, fin = box([0, 0, 0], [10, 10, 10]), box([4.9, 0, 10], [5.1, 10, 24])
    for geometry, is_thin in ((solid(block, fin), True), (solid(block), False)):
        result = tusqh.mesh((geometry.points, geometry.triangles), cells=16)
        assert ("thin_walls" in warnings(result).index) == is_thin


@pytest.mark.parametrize(
    "make",
    [
        lambda: trimesh.creation.icosphere(3, 1.0),
        lambda: trimesh.creation.torus(1.0, 0.4, 32, 16),
        lambda: trimesh.creation.cone(0.5, 2.0),
        lambda: trimesh.creation.cylinder(0.5, 2.0),
        lambda: trimesh.creation.annulus(0.4, 1.0, 1.0),
        lambda: trimesh.creation.capsule(2.0, 0.5),
    ],
)
def test_ordinary_solids_have_no_thin_walls(make):
    mesh = make()
    thickness = measure_thickness(solid(mesh))
    assert thickness.share_below(mesh.extents.max() / 24) < 0.1
