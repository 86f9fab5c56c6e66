"""Every material and the whole are judged by VTK, MFEM and pymeshlab as a mesh of its own is."""

import numpy as np
import pandas as pd
import pytest
from needs import import_or_require

import tusqh
from tusqh.meshes.regions import Regions
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.pipeline.judge import judge
from tusqh.pipeline.materials.judge import judge_all, measure_materials
from tusqh.quality.summary import facts_of_materials, summarise_materials, summarise_verdict

OTHERS = ("scaled_jacobian_vtk", "matrix_components", "pymeshlab_connected_components")


@pytest.fixture(scope="module", params=[(9, 8), (6, 5, 5)], ids=["quads", "hexes"])
def found(request):
    """Noise of three labels and void, with contacts of all kinds."""
    import_or_require("pymeshlab")
    image = np.random.default_rng(len(request.param)).integers(0, 4, request.param)
    names = {1: "bone", 2: "marrow", 3: "skin"}
    return tusqh.mesh(image, materials=names, volume_tolerance=1.0, name="noise")


def test_the_checks_of_a_material_are_those_of_its_mesh_alone(found):
    """Compare with the verdict on the same elements, written as a mesh of one material."""
    verdict = found.verdict.set_index("id")
    assert set(verdict["holds"]) == {"yes"}
    solid = found.mesh.take(np.arange(found.mesh.n_cells), name="all")
    for name in ("bone", "marrow", "skin", "all"):
        part = solid if name == "all" else found.part(name)
        predicted = found.built.predicted_solid if name == "all" else found.built.predicted[name]
        alone = judge(part, predicted).verdict.set_index("id")
        for check in OTHERS:
            row = verdict.loc[f"{check}_{name}"]
            assert row["material"] == name
            assert row["found"] == alone.loc[check, "found"]
            assert row["required"] == alone.loc[check, "required"]


def test_wrong_predictions_and_materials_fail_their_own_rows_only(found):
    """A prediction of one component too many fails for that material, by every method."""
    regions = Regions(found.names, found.built.material)
    measured = measure_materials(found.mesh, regions)
    predicted = {name: m.by_euler for name, m in measured.items()}
    right = judge_all(found.mesh, regions, measured, predicted)
    assert right.is_suitable
    bone = predicted["bone"]
    predicted["bone"] = bone._replace(betti_0=bone.betti_0 + 1)
    wrong = judge_all(found.mesh, regions, measured, predicted).verdict
    failed = wrong[wrong["holds"] == "no"]
    assert set(failed["material"]) == {"bone"}
    assert {f"{check}_bone" for check in OTHERS[1:]} < set(failed["id"])
    # Labels at random are no manifolds, and other programs are then not asked.
    rng = np.random.default_rng(1)
    drawn = Regions(found.names, rng.integers(0, 3, found.mesh.n_cells))
    judged = judge_all(found.mesh, drawn, measure_materials(found.mesh, drawn)).verdict
    assert (judged["holds"] == "no").any()
    assert not judged["id"].str.startswith("pymeshlab").any()


def test_large_meshes_are_checked_by_others_only_if_asked(found, monkeypatch):
    monkeypatch.setattr("tusqh.pipeline.materials.judge.MOST_ELEMENTS", 10)
    regions = Regions(found.names, found.built.material)
    measured = measure_materials(found.mesh, regions)
    skipped = judge_all(found.mesh, regions, measured)
    rows = skipped.verdict.set_index("id")
    assert rows.loc["checks_by_mfem", "holds"] == "not run"
    assert "--all-checks" in rows.loc["checks_by_mfem", "found"]
    assert skipped.elements.empty
    asked = judge_all(found.mesh, regions, measured, checks="all")
    assert set(asked.verdict["holds"]) == {"yes"}
    assert len(asked.elements) == 5


def test_the_option_reaches_the_verdict():
    image = np.ones((3, 3), dtype=np.uint8)
    assert tusqh.mesh(image, materials="labels", checks="all").checks == "all"
    assert tusqh.mesh(image, materials="labels").checks is None


def test_overlapping_elements_of_a_material_are_found():
    """A square of material a lies on one of material b, and shares no point with it."""
    square, step = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]), np.array([0.5, 0.3])
    mesh = VolumeMesh.from_arrays(
        np.concatenate([square, square + step]), [[0, 1, 2, 3], [4, 5, 6, 7]]
    )
    regions = Regions(("a", "b", "void"), np.array([0, 1]))
    verdict = judge_all(mesh, regions, measure_materials(mesh, regions)).verdict
    holds = verdict.set_index("id")["holds"]
    assert holds["overlap"] == "no"
    assert holds["overlap_a"] == holds["overlap_b"] == "yes"


def test_the_summary_has_a_row_for_each_material_and_the_whole(found, tmp_path):
    found.save(tmp_path)
    tables = [pd.read_csv(tmp_path / f"{n}.csv") for n in ("materials", "verification", "verdict")]
    amount = pd.DataFrame({"amount_relative_error": [0.0, -1e-12]})
    rows = pd.DataFrame(summarise_materials(*tables, amount)).set_index("material")
    assert list(rows.index) == ["bone", "marrow", "skin", "all"]
    assert rows.loc["all", "verdict"] == "suitable"
    assert rows.loc["all", "amount_relative_error"] == 1e-12
    assert rows["elements"].iloc[:3].sum() == rows.loc["all", "elements"] == found.mesh.n_cells
    for name in ("bone", "all"):
        assert rows.loc[name, "betti_measured"] == rows.loc[name, "betti_predicted"]
    # A check of one material fails: that material and the whole are not suitable.
    tables[2].loc[tables[2]["id"] == "manifold_skin", "holds"] = "no"
    verdicts = pd.DataFrame(summarise_materials(*tables)).set_index("material")["verdict"]
    assert verdicts.str.startswith("not suitable").to_dict() == {
        "bone": False, "marrow": False, "skin": True, "all": True
    }  # fmt: skip
    facts = facts_of_materials("noise", tables[0])
    row = summarise_verdict(facts, tables[2], file="noise.npy")
    assert row["verdict"] == "not suitable"
    assert row["volume_ratio"] == pytest.approx(found.mesh.measurement.volume / (
        found.fractions.grid.n_cells - found.fractions.volumes()["void"]))  # fmt: skip
