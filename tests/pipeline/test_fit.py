"""The stage `fit`: the fitted mesh beside the staircase, its record, and the check of both."""

import json

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

import tusqh
from tusqh.cli.app import app
from tusqh.errors import ConfigError, MeshError
from tusqh.files import path_of
from tusqh.meshes.export import read_vtu, write_vtu
from tusqh.pipeline.fit import load_fit, read_facts
from tusqh.settings.model import Model

TURNS = np.linspace(0, 2 * np.pi, 97)[:-1]
RING = np.concatenate([np.column_stack([np.cos(TURNS), np.sin(TURNS)]) * r for r in (1.0, 0.45)])
LINES = [[k, (k + 1) % 96] for k in range(96)] + [[96 + (k + 1) % 96, 96 + k] for k in range(96)]


@pytest.fixture(scope="module")
def fitted():
    return tusqh.mesh((RING, LINES), cells=20, betti=(1, 1), name="ring", fit=True)


@pytest.fixture
def folder(fitted, tmp_path):
    fitted.save(tmp_path)
    return tmp_path


def check(path):
    done = CliRunner().invoke(app, ["check", str(path)], env={"COLUMNS": "400"})
    return done.exit_code, done.output


def test_the_result_is_the_fitted_mesh_and_has_the_staircase_beside_it(fitted):
    assert fitted.mesh.n_cells > fitted.staircase.n_cells
    assert fitted.report.facts["elements"] == fitted.mesh.n_cells
    assert fitted.report.measured == fitted.selection.predicted == (1, 1, 0)
    exact = np.pi * (1 - 0.45**2)
    errors = [abs(m.measurement.volume / exact - 1) for m in (fitted.staircase, fitted.mesh)]
    assert errors[1] < 2e-3 < errors[0]
    ids = set(fitted.judgement.verdict["id"])
    assert {"distance_mean", "distance_p99", "fell_back", "volume"} <= ids
    assert fitted.report.is_suitable
    assert "cells from the surface" in str(fitted.report)


def test_without_the_setting_the_mesh_is_the_staircase(fitted):
    plain = tusqh.mesh((RING, LINES), cells=20, betti=(1, 1), name="ring", fit=False)
    assert plain.mesh.points.tobytes() == fitted.staircase.points.tobytes()
    assert plain.mesh is plain.staircase
    assert "fit" not in plain.facts


def test_the_files_are_those_of_the_map_and_both_meshes_pass_the_check(folder):
    for name in ("mesh", "fitted", "fit", "distances", "unfitted", "patches", "chains"):
        assert path_of(name, folder).is_file()
    for name in ("mesh", "fitted"):
        code, said = check(path_of(name, folder))
        assert code == 0, said
    assert "record of the fit: distances" in said
    facts = read_facts(path_of("facts", folder), path_of("fit", folder))
    assert facts["elements"] == read_vtu(path_of("fitted", folder)).n_cells


def test_a_moved_point_fails_the_check(folder):
    path = path_of("fitted", folder)
    mesh = read_vtu(path)
    far = int(np.linalg.norm(mesh.points, axis=1).argmax())
    mesh.points[far] *= 0.97
    write_vtu(path, mesh)
    code, said = check(path)
    assert code == 1
    failed = {line.split("│")[1].strip() for line in said.splitlines() if " no " in line}
    assert {"fit_mesh", "fit_distances"} <= failed


def test_other_distances_in_the_record_fail_the_check(folder):
    record = path_of("fit", folder)
    stored = json.loads(record.read_text())
    stored["all_distances"][0]["mean"] /= 2
    record.write_text(json.dumps(stored))
    code, said = check(path_of("fitted", folder))
    assert code == 1
    assert "1 of 36 differ" in said


def test_without_the_geometry_the_distances_are_those_recorded(folder):
    path_of("geometry", folder).unlink()
    code, said = check(path_of("fitted", folder))
    assert code == 0
    assert "geometry.vtp is missing" in said


def test_a_damaged_record_is_an_error_that_names_the_file(tmp_path):
    (tmp_path / "fit.json").write_text("{")
    with pytest.raises(MeshError, match=r"fit\.json"):
        load_fit(tmp_path / "fit.json")
    (tmp_path / "fit.json").write_text("{}")
    with pytest.raises(MeshError, match="lacks"):
        load_fit(tmp_path / "fit.json")


def test_several_materials_get_a_remark_and_a_model_an_error():
    labels = np.array([[1, 1, 0], [1, 2, 2], [0, 2, 2]])
    found = tusqh.mesh(labels, materials={1: "shell", 2: "core"}, fit=True)
    assert any("`fit` does not apply" in str(remark) for remark in found.remarks)
    with pytest.raises(ConfigError, match="fit"):
        Model.from_dict({"geometry": "a.npy", "materials": "labels", "fit": True})


def test_the_command_line_switches_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    ends = RING[np.array(LINES)].reshape(-1, 4)
    pd.DataFrame(ends, columns=["x0", "y0", "x1", "y1"]).to_csv("ring.csv", index=False)
    words = ["mesh", "ring.csv", "--cells", "10", "--json"]
    found = {}
    for switch in ("--fit", "--no-fit"):
        done = CliRunner().invoke(app, [*words, switch, "-o", f"a{switch}.vtu"])
        assert done.exit_code in (0, 3), done.output
        found[switch] = json.loads(done.output)["mesh"]
        assert read_vtu(tmp_path / f"a{switch}.vtu").n_cells == found[switch]["elements"]
    assert "fit" in found["--fit"]
    assert "fit" not in found["--no-fit"]


def test_a_solid_is_fitted_too(repository):
    torus = repository / "data_sources/solids/torus.stl"
    result = tusqh.mesh(torus, cells=14, betti=(1, 1, 0), fit=True)
    assert result.report.measured == (1, 1, 0)
    assert result.report.is_suitable
    assert result.facts["fit"]["mean_distance"] < 0.1
