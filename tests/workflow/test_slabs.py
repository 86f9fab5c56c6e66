"""A model in slabs, of which every slab is a job of its own."""

import json

import numpy as np
import pandas as pd
import pytest
import trimesh
from workflow_runs import fail, succeed

import tusqh
from tusqh.meshes.piece_files import read_pieces
from tusqh.pipeline.slabs.recheck import check_in_pieces

CONFIG = """models:
  ring: {geometry: ring.stl, unit: mm, grid: {cells: 12}, slabs: 3}
"""
SLABS = ["0000", "0001", "0002"]


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """Return a folder with a model in slabs and its results."""
    folder = tmp_path_factory.mktemp("slabs")
    (folder / "config").mkdir()
    (folder / "config/config.yaml").write_text(CONFIG)
    trimesh.creation.torus(10.0, 4.0, major_sections=24, minor_sections=12).export(
        folder / "ring.stl"
    )
    succeed(folder, "models", "results/tables/summary.csv", "results/tables/verdicts.csv")
    return folder


@pytest.mark.slow
def test_jobs_make_the_mesh_of_one_piece_point_for_point(project):
    folder = project / "results/ring"
    assert sorted(path.stem for path in (folder / "mesh_pieces").iterdir()) == SLABS
    pieces = list(read_pieces(folder / "mesh.pvtu"))
    whole = tusqh.mesh(project / "ring.stl", cells=12, unit="mm").mesh
    points = np.full(whole.points.shape, np.nan)
    for piece in pieces:
        points[piece.numbers] = piece.points
    assert np.array_equal(points, whole.points)
    assert np.array_equal(np.concatenate([p.numbers[p.cells] for p in pieces]), whole.cells)


@pytest.mark.slow
def test_every_step_is_recorded_and_the_certificate_holds(project):
    records = {path.stem for path in (project / "results/provenance/ring").glob("*.json")}
    for step in ("slab_sample", "slab_elements", "slab_piece"):
        assert {f"{step}_{slab}" for slab in SLABS} < records
    table, measured = check_in_pieces(project / "results/ring/mesh.pvtu")
    assert set(table["holds"]) == {"yes", "not run"}
    assert measured.by_boundary == (1, 1, 0)
    facts = json.loads((project / "results/ring/facts.json").read_text())
    assert "error" in facts["placement"]


@pytest.mark.slow
def test_the_summary_has_the_model_and_says_that_it_is_in_slabs(project):
    (row,) = pd.read_csv(project / "results/tables/summary.csv").to_dict("records")
    assert (row["model"], row["slabs"]) == ("ring", 3)
    assert row["betti_measured"] == "(1, 1, 0)"
    (row,) = pd.read_csv(project / "results/tables/verdicts.csv").to_dict("records")
    assert row["file"] == "ring.stl"
    assert "nan" not in str(row["volume_ratio"])


@pytest.mark.slow
def test_a_missing_slab_is_made_again_with_what_depends_on_it(project):
    piece, mesh = (
        project / "results/ring" / name for name in ("mesh_pieces/0001.vtu", "mesh.pvtu")
    )
    piece.unlink()
    mesh.unlink()
    jobs = succeed(project, "models", "--dry-run")
    assert "slab_piece" in jobs
    assert "slab_elements" not in jobs
    succeed(project, "models")
    assert piece.is_file()
    assert mesh.is_file()


def test_every_slab_is_a_job(tmp_path):
    (tmp_path / "config.yaml").write_text(CONFIG)
    (tmp_path / "ring.stl").write_text("not read before it is needed")
    text = succeed(tmp_path, "--dry-run", "--configfile", "config.yaml")
    jobs = dict(line.split()[:2] for line in text.splitlines() if line.startswith("slab_"))
    ones = {"slab_ingest", "slab_grid", "slab_contacts", "slab_mesh"}
    each = {"slab_sample", "slab_elements", "slab_piece"}
    assert jobs == dict.fromkeys(ones, "1") | dict.fromkeys(each, "3")
    text = succeed(
        tmp_path,
        "--dry-run",
        "--config",
        "models={ring: {slabs: auto}}",
        "--configfile",
        "config.yaml",
    )
    assert dict(line.split()[:2] for line in text.splitlines() if "slab_piece " in line) == {
        "slab_piece": "1"
    }


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("slabs: 3", "slabs: 3, fit: true"), "models.ring.slabs: found 3 with `fit`"),
        (("ring.stl", "ring.svg"), "models.ring.slabs: found ring.svg, expected a surface"),
    ],
)
def test_what_slabs_cannot_do_is_refused_when_the_configuration_is_read(tmp_path, change, message):
    (tmp_path / "config.yaml").write_text(CONFIG.replace(*change))
    assert message in fail(tmp_path, "--dry-run", "--configfile", "config.yaml")
