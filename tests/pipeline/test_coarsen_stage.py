"""The stage that makes a coarse mesh, its files and `tusqh check`."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

import tusqh
from tusqh.cli.app import app
from tusqh.coarsening.files import read_coarse, write_coarse
from tusqh.errors import ConfigError, MeshError


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    """Return the folder and the result of a fitted ball of voxels with a coarse inside."""
    axes = np.meshgrid(*3 * [np.arange(40) - 19.5], indexing="ij")
    radius = np.sqrt(sum(axis**2 for axis in axes))
    voxels = np.clip(17.5 - radius, 0, 1)
    result = tusqh.mesh(voxels, cells=40, threshold=0.5, coarsen="interior", name="ball")
    folder = tmp_path_factory.mktemp("ball")
    result.save(folder)
    return folder, result


def check(path):
    """Return the exit code and the output of `tusqh check`."""
    found = CliRunner().invoke(app, ["check", str(path)])
    return found.exit_code, found.output


def test_the_result_has_both_meshes(saved):
    folder, result = saved
    assert result.coarse.n_uniform == result.mesh.n_cells
    assert result.coarse.mesh.n_cells < 0.6 * result.mesh.n_cells
    line = str(result.report).split("coarse ")[1].splitlines()[0]
    assert f"{result.coarse.mesh.n_cells:,} elements instead of {result.mesh.n_cells:,}" in line
    assert (folder / "coarse.mesh").read_text().startswith("MFEM mesh v1.1")
    record = json.loads((folder / "coarsening.json").read_text())
    assert record["elements"] == result.coarse.mesh.n_cells
    assert sum(record["elements_by_level"]) == record["elements"]


def test_a_mesh_that_was_not_asked_for_is_not_made():
    result = tusqh.mesh(np.ones((8, 8, 8)), cells=8, threshold=0.5, name="block")
    assert result.coarse is None
    assert "coarse" not in str(result.report)


def test_check_recomputes_the_coarse_mesh(saved):
    code, output = check(saved[0] / "coarse.vtu")
    assert code == 0, output
    assert "which stand for" in output
    code, output = check(saved[0] / "mesh.vtu")
    assert code == 0, output


def test_check_finds_another_coarse_mesh(saved, tmp_path):
    folder, result = saved
    for name in ("coarsening.json", "mesh.vtu", "certificate.json"):
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    coarse = result.coarse
    moved = coarse.mesh.points.copy()
    moved[coarse.hanging[0, 0], 0] += 1e-3
    object.__setattr__(coarse.mesh, "points", moved)
    try:
        write_coarse(tmp_path / "coarse.vtu", coarse)
    finally:
        moved[coarse.hanging[0, 0], 0] -= 1e-3
    code, output = check(tmp_path / "coarse.vtu")
    assert code == 1
    assert "coarse_digest" in output


def test_outputs_that_cannot_hold_hanging_vertices_are_refused_before_work(tmp_path):
    np.save(tmp_path / "block.npy", np.ones((8, 8, 8)))
    words = ["mesh", str(tmp_path / "block.npy"), "--coarsen", "interior"]
    words += ["-o", str(tmp_path / "a.inp")]
    found = CliRunner().invoke(app, words)
    assert isinstance(found.exception, MeshError)
    assert "cannot hold the hanging vertices" in str(found.exception)
    words[-1] = str(tmp_path / "a.vtu")
    assert CliRunner().invoke(app, words).exit_code == 0
    assert read_coarse(tmp_path / "a.vtu").n_uniform == 512


def test_a_conforming_mesh_is_written_checked_and_exported(tmp_path):
    voxels = np.ones((24, 24, 24))
    voxels[:, 10:13, 10:13] = 0
    result = tusqh.mesh(voxels, cells=24, threshold=0.5, coarsen="conforming", name="ring")
    assert "conforming" in str(result.report)
    result.save(tmp_path)
    assert (tmp_path / "coarse.mesh").read_text().startswith("MFEM mesh v1.0")
    code, output = check(tmp_path / "coarse.vtu")
    assert code == 0, output
    assert "other elements" not in output
    result.write(tmp_path / "ring.inp")
    assert "hole_1" in (tmp_path / "ring.inp").read_text().lower()
    record = json.loads((tmp_path / "coarsening.json").read_text())
    assert record["elements"] < record["uniform_elements"]
    coarse = result.coarse
    moved = coarse.mesh.points.copy()
    moved[coarse.mesh.cells[coarse.mesh.kind == 6][0, 0]] += 0.02
    object.__setattr__(coarse.mesh, "points", moved)
    write_coarse(tmp_path / "coarse.vtu", coarse)
    code, output = check(tmp_path / "coarse.vtu")
    assert code == 1
    assert "coarse_digest" in output


def test_another_word_is_an_error():
    with pytest.raises(ConfigError, match="interior"):
        tusqh.mesh(np.ones((8, 8, 8)), cells=8, threshold=0.5, coarsen="outside", name="block")


def test_several_materials_say_that_they_are_not_coarsened():
    labels = np.ones((6, 6, 6), dtype=np.uint8)
    labels[:3] = 2
    result = tusqh.mesh(labels, materials="labels", cells=6, coarsen="interior", name="two")
    assert any("`coarsen` does not apply to several materials" in str(r) for r in result.remarks)
