"""The whole workflow on a model in the plane: its results, and how mistakes end."""

import json
import math
import re
import subprocess
import sys

import pandas as pd
import pytest
from drawings import is_drawn
from small_project import PLATE
from workflow_runs import fail, succeed

from tusqh.hashing import hash_file
from tusqh.meshes.betti import betti_by_boundary
from tusqh.meshes.export import read_vtu

CONFIG = """models:
  plate:
    geometry: plate.svg
    unit: mm
    grid: {cells: 32}
    target: {betti_0: 1, betti_1: 2}
"""


def test_the_mesh_has_the_wanted_topology(built):
    assert betti_by_boundary(read_vtu(built / "results/plate/mesh.vtu")) == (1, 2, 0)
    summary = pd.read_csv(built / "results/tables/summary.csv")
    assert summary.set_index("model")["verdict"]["plate"].startswith("suitable")
    rows = pd.read_csv(built / "results/tables/verification.csv").query("dimension == 2")
    assert rows["holds"].all()  # Also those of meshes with local scope.
    verification = rows.query("scope == 'global'")
    assert verification["holds"].all()
    assert verification["threshold"].tolist() == [0.9, 0.75, 0.5, 0.25, 0.15, 0.05, 0.01]
    for threshold in verification["threshold"]:
        assert (built / f"results/plate/sweep/{threshold}.vtu").stat().st_size > 0
    defects = pd.read_csv(built / "results/plate/defects.csv").set_index("defect")["count"]
    assert defects["open_chains"] == 1
    assert defects["open_ends"] == 2
    reading = json.loads((built / "results/plate/reading.json").read_text())
    assert (reading["format"], reading["closed"]) == ("SVG", False)
    assert reading["counts"]["open_ends"] == 2


def test_the_certificate_is_beside_the_mesh_and_holds(built):
    certificate = json.loads((built / "results/plate/certificate.json").read_text())
    assert certificate["selection"]["wanted"] == "the threshold 0.5"
    assert certificate["measured"] == {"euler": [1, 2, 0], "boundary": [1, 2, 0]}
    assert certificate["mesh"]["sha256"] == hash_file(built / "results/plate/mesh.vtu")
    mesh = str(built / "results/plate/mesh.vtu")
    command = [sys.executable, "-m", "tusqh", "check", mesh]
    assert subprocess.run(command, capture_output=True).returncode == 0


def test_the_boundary_is_fitted_and_later_steps_take_the_fitted_mesh(built):
    folder = built / "results/plate"
    staircase, fitted = (read_vtu(folder / f"{name}.vtu") for name in ("mesh", "fitted"))
    assert fitted.n_cells > staircase.n_cells
    table = pd.read_csv(built / "results/tables/fit.csv").set_index("model")
    assert table.index.tolist() == ["plate"]
    row = table.loc["plate"]
    assert row["elements"] == fitted.n_cells
    assert row["min_scaled_jacobian"] == pytest.approx(fitted.jacobians.scaled.min())
    assert row["betti_same"]
    assert row["mean_distance"] < 0.05
    assert row["self_intersections"] == 0
    # The plate has a round hole of radius 10 and a square one with sides of 20, in 80 by 40.
    exact = 80 * 40 - 20 * 20 - math.pi * 10**2
    assert abs(fitted.measurement.volume / exact - 1) < 1e-3
    exported = (folder / "export/mesh.mesh").read_text()
    assert f"elements\n{fitted.n_cells}\n" in exported
    summary = pd.read_csv(built / "results/tables/summary.csv").set_index("model")
    assert summary.loc["plate", "elements"] == fitted.n_cells
    assert all(is_drawn(folder / f"figures/{n}.png") for n in ("fit", "sets", "jacobians"))
    assert {"hole", "patch"} <= set(pd.read_csv(folder / "sets.csv")["kind"])
    assert "cells from the surface" in (built / "results/report/index.html").read_text()
    command = [sys.executable, "-m", "tusqh", "check", str(folder / "fitted.vtu")]
    assert subprocess.run(command, capture_output=True).returncode == 0


def test_the_diagram_says_where_each_hole_is(built):
    pairs = pd.read_csv(built / "results/plate/diagram.csv")
    deep = pairs[(pairs["dimension"] == 1) & (pairs["persistence"] > 0.9)]
    # The round hole is around (20, 20), the square one around (60, 20); y points up.
    assert len(deep) == 2
    for row, centre in zip(deep.sort_values("death_x").itertuples(), (20, 60), strict=True):
        assert abs(row.death_x - centre) <= 10
        assert abs(row.death_y + 20) <= 10
        assert row.death_at == "cell"
        assert 0 <= row.death_i < 32
    diagonal = pd.read_csv(built / "results/plate/diagonal.csv")
    assert diagonal["pairs"].sum() > 100


def test_the_explorer_shows_the_mesh_and_its_command(built):
    page = (built / "results/plate/explorer.html").read_text(encoding="utf-8")
    facts = json.loads(re.search(r'id="facts-json">(.*?)</script>', page, re.DOTALL)[1])
    assert (
        facts["command"]["before"] == "tusqh mesh data_sources/plate.svg --cells 32 --unit mm --fit"
    )
    assert facts["unit"] == "mm"
    assert dict(facts["head"])["its Betti numbers"] == "1, 2"
    assert facts["tables"]["verdict"]["rows"]


def test_every_figure_shows_something(built):
    for figure in ("thresholds", "diagram", "antialias", "contaminant"):
        assert is_drawn(built / f"results/plate/figures/{figure}.png"), figure


def test_records_name_every_input_and_output_with_its_hash(built):
    found = sorted((built / "results/provenance").rglob("*.json"))
    records = [p for p in found if p.parent.name != "code"]  # Lists of code are not records.
    whats = [json.loads(p.read_text()) for p in records if not p.name.endswith(".how.json")]
    assert {what["step"] for what in whats} >= {"ingest", "sample", "select", "mesh", "tables"}
    made = {}
    for what in whats:
        for entry in what["inputs"] + what["outputs"]:
            assert hash_file(built / entry["path"]) == entry["sha256"]
        made |= {entry["path"]: entry["sha256"] for entry in what["outputs"]}
    for what in whats:
        for entry in what["inputs"]:
            assert (
                entry["path"].startswith("data_sources/") or made[entry["path"]] == entry["sha256"]
            )
    hows = [json.loads(p.read_text()) for p in records if p.name.endswith(".how.json")]
    assert len(hows) == len(whats)
    assert all(how["seconds"] >= 0 and how["versions"]["numpy"] for how in hows)


def test_a_second_run_does_nothing(built):
    assert "Nothing to be done" in succeed(built)


def prepare(folder, config=CONFIG, plate=PLATE):
    (folder / "config").mkdir()
    (folder / "config/config.yaml").write_text(config)
    (folder / "plate.svg").write_text(plate)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("plate.svg", "plaet.svg"), "plaet.svg"),
        (("unit: mm", "untis: mm"), "did you mean 'unit'"),
    ],
)
def test_mistakes_in_the_configuration_end_before_any_step(tmp_path, change, message):
    prepare(tmp_path, CONFIG.replace(*change))
    assert message in fail(tmp_path, "results/plate/mesh.vtu")
    assert not (tmp_path / "results/plate").exists()


def test_mistakes_in_models_end_with_a_message_and_nothing_half_written(tmp_path):
    contents = {
        "empty": "",
        "cut_off": "<svg",
        "without_paths": "<svg xmlns='http://www.w3.org/2000/svg'></svg>",
        "unreachable": PLATE,
        "outside": PLATE,
    }
    changes = {
        "unreachable": ("betti_1: 2}", "betti_1: 200}"),
        "outside": ("grid: {cells: 32}", "window: {lower: [900, 0], upper: [950, 9]}"),
    }
    entry = CONFIG.removeprefix("models:\n")
    config = "models:\n"
    (tmp_path / "config").mkdir()
    for name, content in contents.items():
        config += entry.replace("plate", name).replace(*changes.get(name, ("", "")))
        (tmp_path / f"{name}.svg").write_text(content)
    (tmp_path / "config/config.yaml").write_text(config)
    targets = [f"results/{name}/mesh.vtu" for name in contents]
    messages = fail(tmp_path, "--keep-going", *targets)
    assert messages.count("error in ") >= 3
    assert messages.count("remedy:") >= 5
    assert "no threshold gives betti_0 = 1, betti_1 = 200" in messages
    assert "misses the geometry" in messages
    for name in ("empty", "cut_off", "without_paths"):
        assert not (tmp_path / f"results/{name}/geometry.vtp").exists()
    assert not list(tmp_path.rglob("mesh.vtu"))
    assert not list(tmp_path.rglob(".mesh-*"))
