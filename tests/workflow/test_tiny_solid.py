"""The whole workflow on a model in space: its results and the pages about them."""

import json
import re
import subprocess
import sys
from urllib.parse import unquote

import pandas as pd
import yaml
from drawings import is_drawn
from small_project import copy_results
from workflow_runs import fail, succeed

from tusqh.files import TABLES_OF_ALL_MODELS
from tusqh.meshes.betti import betti_by_boundary
from tusqh.meshes.export import read_vtu


def test_the_mesh_has_the_wanted_topology(built):
    assert betti_by_boundary(read_vtu(built / "results/ring/mesh.vtu")) == (1, 1, 0)
    summary = pd.read_csv(built / "results/tables/summary.csv").set_index("model").loc["ring"]
    assert summary["verdict"].startswith("suitable")
    assert abs(summary["volume_over_winding"] - 1) < 0.2
    defects = pd.read_csv(built / "results/ring/defects.csv").set_index("defect")["count"]
    assert defects["boundary_edges"] == 6


def test_the_table_of_verdicts_has_every_model(built):
    table = pd.read_csv(built / "results/tables/verdicts.csv").set_index("model")
    assert list(table.columns) == list(TABLES_OF_ALL_MODELS[0].columns[1:])
    assert table["file"].to_dict() == {
        "plate": "data_sources/plate.svg",
        "ring": "data_sources/ring.stl",
    }
    assert (table["volume_ratio"] - 1).abs().max() < 0.05
    assert table["verdict"].str.startswith("suitable").all()
    facts = json.loads((built / "results/ring/facts.json").read_text())
    assert "error" in facts["placement"]


def test_eight_thresholds_are_verified(built):
    verification = pd.read_csv(built / "results/tables/verification.csv")
    verification = verification.query("dimension == 3 and scope == 'global'")
    assert verification["threshold"].tolist() == [k / 8 for k in range(1, 9)]
    assert verification["holds"].all()
    for threshold in verification["threshold"]:
        assert (built / f"results/ring/sweep/{threshold}.vtu").is_file()


def test_figures_exports_and_certificate_are_there(built):
    for figure in (
        "ring/figures/panels",
        "ring/figures/section",
        "ring/figures/diagram",
        "ring/figures/temperature",
    ):
        assert is_drawn(built / f"results/{figure}.png"), figure
    assert is_drawn(built / "results/figures/pinches.png")
    for suffix in ("mesh", "msh", "exo", "inp"):
        assert (built / f"results/ring/export/mesh.{suffix}").stat().st_size > 10_000
    certificate = json.loads((built / "results/ring/certificate.json").read_text())
    assert certificate["measured"] == {"euler": [1, 1, 0], "boundary": [1, 1, 0]}
    command = [sys.executable, "-m", "tusqh", "check", str(built / "results/ring/mesh.vtu")]
    assert subprocess.run(command, capture_output=True).returncode == 0


def test_the_overview_links_to_files_that_are_there(built):
    page = built / "results/report/index.html"
    text = page.read_text()
    assert "2 of 2 models" in text
    links = re.findall(r'(?:href|src)="([^"#][^"]*)"', text)
    assert len(links) > 12
    for link in links:
        assert (page.parent / unquote(link)).is_file(), link
    captions = re.findall(r"<figcaption>(.*?)</figcaption>", text)
    assert "The model, and its mesh at every threshold of the sweep" in " ".join(captions)


def test_snakemakes_own_report_has_captions(built, tmp_path):
    folder = tmp_path / "reported"
    copy_results(built, folder)
    succeed(folder, "--report", "report.html")
    text = (folder / "report.html").read_text()
    assert len(text) > 500_000
    for caption in ("its mesh at every threshold of the sweep", "Every check of the mesh"):
        assert caption in text


def test_holes_of_a_solid_cannot_be_filled(built, tmp_path):
    ring = yaml.safe_load((built / "config/config.yaml").read_text())["models"]["ring"]
    (tmp_path / "config").mkdir()
    config = {"models": {"filled": ring | {"holes": {"min_cells": 2}}}}
    (tmp_path / "config/config.yaml").write_text(yaml.safe_dump(config))
    (tmp_path / "data_sources").symlink_to(built / "data_sources")
    messages = fail(tmp_path, "results/filled/selection.json")
    assert "`holes` of a 3D model" in messages
