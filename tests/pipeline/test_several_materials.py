"""`tusqh.mesh` of several materials: files, parts, labels, wishes, and what is wrong with them."""

import numpy as np
import pytest
import trimesh
from shapes import box

import tusqh
from tusqh.contacts import MaterialFractions, mesh_materials
from tusqh.contacts.material_fractions import FULL
from tusqh.contacts.score_field import score_field
from tusqh.errors import ConfigError, GeometryError, SamplingError, TopologyError
from tusqh.geometry.soup import Soup
from tusqh.grid import BackgroundGrid, doubled


@pytest.fixture
def files(tmp_path):
    """A ring and a ball that overlap, each in a file, and both in one file."""
    ring = trimesh.creation.torus(3.0, 1.0)
    ball = trimesh.creation.icosphere(subdivisions=2, radius=2.4)
    ring.export(tmp_path / "ring.stl")
    ball.export(tmp_path / "ball.stl")
    trimesh.util.concatenate([ring, ball]).export(tmp_path / "both.stl")
    return tmp_path


def numbers(found):
    """Return the measured Betti numbers of every material, and of all."""
    rows = found.materials
    betti = rows[[f"betti_{k}_measured" for k in range(3)]].to_numpy().tolist()
    return {name: tuple(row) for name, row in zip(rows["material"], betti, strict=True)}


def test_files_parts_and_objects_give_the_same_mesh(files):
    separate = tusqh.mesh([files / "ring.stl", files / "ball.stl"], cells=16)
    assert numbers(separate) == {"ring": (1, 1, 0), "ball": (1, 0, 0), "all": (1, 0, 0)}
    assert separate.is_as_predicted
    parts = tusqh.mesh(files / "both.stl", cells=16, materials="parts")
    named = tusqh.mesh({"a": trimesh.load(files / "ring.stl"), "b": files / "ball.stl"}, cells=16)
    for other in (parts, named):
        assert np.array_equal(other.mesh.cells, separate.mesh.cells)
        assert np.array_equal(other.built.material, separate.built.material)
    assert separate.pairs["overlap"].tolist() == parts.pairs["overlap"].tolist()
    assert separate.pairs["overlap"][0] > 1


def test_labels_have_names_and_void_is_label_0():
    image = np.zeros((6, 6, 6), dtype=np.uint8)
    image[1:5, 1:5, 1:5], image[2:4, 2:4, 2:4] = 3, 7
    found = tusqh.mesh(image, materials={3: "bone", 7: "marrow"})
    assert numbers(found) == {"bone": (1, 0, 1), "marrow": (1, 0, 0), "all": (1, 0, 0)}
    assert found.fractions.grid.n_cells == 216
    filled = tusqh.mesh(image, materials={3: "bone"}, rest="water")
    assert numbers(filled)["water"] == (1, 0, 1)
    plane = tusqh.mesh(image[3], materials={3: "bone"})
    assert plane.mesh.dim == 2
    assert numbers(plane)["7"] == (1, 0, 0)


def test_a_material_wins_where_its_score_field_is_above_its_threshold():
    rng = np.random.default_rng(2)
    for _ in range(20):
        fields = rng.random((3, 5, 5)) / 3
        multiples = (fields * FULL).astype(np.int32)
        grid = BackgroundGrid((2, 2), 1.0, (0.0, 0.0))
        fractions = MaterialFractions.from_multiples(grid, ["a", "b", "c"], list(multiples))
        t = rng.uniform(0.1, 1.0, 4)
        labels = fractions.label_cells((t * FULL).astype(np.int64))
        for k in range(3):
            field = score_field(fractions, k, t)[doubled.cells(2)] / FULL
            assert np.array_equal(labels == k, field >= t[k] / (1 + t[k]))


def test_targets_are_met_in_turn():
    """Sand fills three quarters of a neck of land."""
    image = np.zeros((24, 12), dtype=np.uint8)
    image[:, 4:8] = 1
    image[8:12, 4:7] = 2
    assert numbers(tusqh.mesh(image, cells=6, materials={1: "land", 2: "sand"}))["land"][0] == 2
    wishes = {1: {"name": "land", "target": {"betti_0": 1}}, 2: "sand"}
    found = tusqh.mesh(image, cells=6, materials=wishes)
    assert numbers(found)["land"][0] == 1
    assert found.is_as_predicted
    assert found.thresholds["land"] < found.thresholds["sand"]
    wishes[2] = {"name": "sand", "target": {"betti_0": 5}}
    with pytest.raises(TopologyError, match="no threshold gives the material 'sand' betti_0 = 5"):
        tusqh.mesh(image, cells=6, materials=wishes)


def test_a_material_without_cells_is_remarked_with_what_would_give_it_some():
    image = np.zeros((8, 8, 8), dtype=np.uint8)
    image[0:4] = 1
    image[5, 5, 5] = 2
    found = tusqh.mesh(image, cells=4, materials={1: "large", 2: "small"})
    (remark,) = found.remarks
    assert remark.what == "material that wins no cell: small"
    assert "a threshold below 0.143, or cells of about 0.5" in remark.remedy
    assert "small" not in numbers(found)
    for better in (
        {"cells": 8},
        {"cells": 4, "materials": {2: {"name": "small", "threshold": 0.14}}},
    ):
        again = tusqh.mesh(image, **{"materials": {2: "small"}, **better})
        assert again.remarks == ()
        assert numbers(again)["small"] == (1, 0, 0)


LABELS = np.array([[1, 2], [0, 1]])
WRONG = [
    (LABELS, {"materials": {1: "a", 2: "a"}}, ConfigError, "found 'a' again"),
    (LABELS, {"materials": {1: "all"}}, ConfigError, "a material called 'all'"),
    (LABELS, {"materials": {3: "a"}}, SamplingError, "no voxel with the labels \\[3\\]"),
    (LABELS, {"materials": {"a": 0.5}}, ConfigError, "no material 'a'"),
    (LABELS, {"materials": {"1": 1.5}}, ConfigError, "found 1.5"),
    (LABELS, {"materials": "cells"}, ConfigError, "found 'cells'"),
    (LABELS, {"materials": {}, "threshold": 0.4}, ConfigError, "threshold together with several"),
    (LABELS, {"materials": {}, "rule": "clamped"}, ConfigError, "rule together with several"),
    (LABELS * 0.5, {"materials": {}}, GeometryError, "2 of 4 voxels are not whole numbers"),
    (np.arange(41_000 * 2).reshape(41_000, 2), {"materials": {}, "cells": 41_000}, SamplingError,
     "81999 labels"),
    ([box((0, 0, 0), (1, 1, 1)), LABELS[None]], {}, GeometryError, "an image as one of several"),
    ([], {}, ConfigError, "no material"),
    (["a.stl", "b/a.stl"], {}, ConfigError, "two materials called 'a'"),
    ([box((0, 0, 0), (1, 1, 1)), ([[0, 0], [1, 0], [1, 1]], [[0, 1], [1, 2], [2, 0]])], {},
     GeometryError, "outlines in the plane and surfaces in space"),
    ([box((0, 0, 0), (1, 1, 1))], {"rest": "void"}, ConfigError, "the rest is called 'void'"),
    ([box((0, 0, 0), (1, 1, 1))], {"rest": "all"}, ConfigError, "the rest is called 'all'"),
    (box((0, 0, 0), (1, 1, 1)), {"materials": [{"name": "a", "part": 2}]}, ConfigError,
     "part 2 of the geometry"),
    (None, {"materials": [{"name": "a"}]}, ConfigError, "no material 'a'"),
]  # fmt: skip


@pytest.mark.parametrize(("source", "options", "kind", "message"), WRONG)
def test_wrong_input_is_named(source, options, kind, message):
    with pytest.raises(kind, match=message):
        tusqh.mesh(source, **options)


def test_fractions_of_cells_are_a_source():
    """Fractions of cells alone give the labels of the largest; edges and vertices are means."""
    fields = np.random.default_rng(3).dirichlet(np.ones(3), (4, 3, 5))
    fractions = MaterialFractions.from_cells({"a": fields[..., 0], "b": fields[..., 1]})
    found = tusqh.mesh(fractions, materials={"a": 0.9})
    assert found.is_as_predicted
    assert found.thresholds["a"] == 0.9
    volumes = found.fractions.volumes()
    assert volumes["a"] == pytest.approx(fields[..., 0].sum(), abs=1e-4)
    whole = fractions.multiples_at(
        np.array([(4 * 7 + 2) * 11 + 4]), np.array([[0]], dtype=np.int32)
    )
    assert whole[0, 0] / FULL == pytest.approx(fields[1:3, 0:2, 1:3, 0].mean(), abs=1e-5)
    with pytest.raises(TopologyError, match="2 cells in which the fractions of"):
        MaterialFractions.from_cells(
            {"a": np.array([[0.9, 0.7, 0.0]]), "b": np.array([[0.6, 0.6, 1.0]])}
        )
    with pytest.raises(SamplingError, match="volume fractions of the shapes"):
        MaterialFractions.from_cells({"a": np.zeros((2, 2)), "b": np.zeros((2, 3))})
    with pytest.raises(ConfigError, match="no material 'c'"):
        tusqh.mesh(fractions, materials={"c": 0.9})


def test_a_volume_that_differs_is_a_warning():
    image = np.array([[1, 1, 1, 1], [1, 1, 1, 2]]).repeat(4, axis=0)
    found = tusqh.mesh(image, cells=4, materials="labels")
    assert found.has_warnings
    (row,) = found.verdict[found.verdict["holds"] == "warning"].itertuples()
    assert row.id == "volume_1"
    assert not tusqh.mesh(image, cells=4, materials="labels", volume_tolerance=0.5).has_warnings


def test_contradicting_wishes_name_the_first_that_fails():
    """Two bands cross in a cell of which each fills half: only one of them can pass."""
    image = np.zeros((12, 12), dtype=np.uint8)
    image[4:8], image[:, 4:8] = 1, 2
    image[4:8, :4] = image[4:8, 8:] = 1
    image[4:6, 4:8] = 1
    one = {1: {"name": "a", "target": {"betti_0": 1}}}
    assert numbers(tusqh.mesh(image, cells=3, materials=one)) == {
        "a": (1, 0, 0), "2": (2, 0, 0), "all": (1, 0, 0)
    }  # fmt: skip
    both = {**one, 2: {"name": "b", "target": {"betti_0": 1}}}
    with pytest.raises(TopologyError, match="wishes contradict each other: 'b' has"):
        tusqh.mesh(image, cells=3, materials=both, scope="global")
    changed = tusqh.mesh(image, cells=3, materials=both)  # With the local scope both can.
    assert changed.part("a").measurement.by_euler.betti_0 == 1
    assert changed.part("b").measurement.by_euler.betti_0 == 1


def test_meshing_again_with_the_thresholds_found_gives_the_same(files):
    found = tusqh.mesh([files / "ring.stl", files / "ball.stl"], cells=12, materials={"ball": 0.5})
    again = mesh_materials(found.fractions, thresholds=found.thresholds)
    assert np.array_equal(again.mesh.points, found.mesh.points)


@pytest.mark.parametrize(
    ("source", "materials", "message"),
    [
        (LABELS, [{"name": "x", "part": 1}], "`part` of the material 'x'"),
        (LABELS, [{"name": "x", "source": "a.stl"}], "`source` of the material 'x'"),
        (box((0, 0, 0), (1, 1, 1)), {1: "x"}, "`label` of the material 'x'"),
    ],
)
def test_keys_of_materials_belong_to_a_kind_of_geometry(source, materials, message):
    with pytest.raises(ConfigError, match=message):
        tusqh.mesh(source, cells=4, materials=materials)


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("a", -0.5, "64 cells with a fraction of 'a'.*-0.5 in cell"),
        ("a", 1.5, "1.5 in cell"),
        ("void", 0.5, "called void"),
    ],
)
def test_fractions_of_cells_are_between_0_and_1(name, value, message):
    with pytest.raises(SamplingError, match=message):
        MaterialFractions.from_cells({name: np.full((4, 4, 4), value)})


def test_a_material_without_any_fraction_is_left_out():
    cells = {"a": np.zeros((3, 3)), "b": np.ones((3, 3))}
    found = tusqh.mesh(MaterialFractions.from_cells(cells))
    assert "fractions are 0 everywhere: a" in str(found.remarks[0])


def test_parts_without_a_sample_in_the_window_are_left_out():
    boxes = [box((3.0 * k, 0, 0), (3.0 * k + 2, 2, 2)) for k in range(3)]
    soup = Soup.from_parts([(b.points, b.triangles) for b in boxes], part_names=["a", "b", "c"])
    settings = {"cells": 5, "window": [[0, 0, 0], [5, 2, 2]]}
    found = tusqh.mesh(soup, materials="parts", **settings)
    assert found.built.names == ("a", "b", "void")
    assert "1 parts without a sample in the window: c" in str(found.remarks[0])
    with pytest.raises(SamplingError, match="no sample lies in the material 'c'"):
        tusqh.mesh(soup, materials={"c": 0.5}, **settings)
