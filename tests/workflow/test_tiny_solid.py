"""The whole workflow on a new solid: an STL and one block in the config."""

import json
import re
import subprocess
import sys
from urllib.parse import unquote

import pandas as pd
import pytest
import trimesh

from tusqh.meshes.betti import betti_by_boundary
from tusqh.meshes.export import read_vtu

CONFIG = """models:
  ring:
    geometry: ring.stl
    unit: mm
    grid: {cells: 14}
    target: {betti_0: 1, betti_1: 1, betti_2: 0}
snapshots: [0, 2, 4, 8, 16, 32]
"""


def snakemake(repository, folder, *arguments):
    command = [sys.executable, "-m", "snakemake", "-s", str(repository / "Snakefile")]
    return subprocess.run(
        [*command, "--cores", "2", *arguments], cwd=folder, capture_output=True, text=True
    )


@pytest.fixture(scope="module")
def built(repository, tmp_path_factory):
    folder = tmp_path_factory.mktemp("solid")
    (folder / "config").mkdir()
    (folder / "config/config.yaml").write_text(CONFIG)
    ring = trimesh.creation.torus(10.0, 3.5)
    ring.update_faces([k not in (7, 90) for k in range(len(ring.faces))])  # Two holes.
    ring.export(folder / "ring.stl")
    done = snakemake(repository, folder)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


def test_the_mesh_has_the_wanted_topology(built):
    assert betti_by_boundary(read_vtu(built / "results/ring/mesh.vtu")) == (1, 1, 0)
    summary = pd.read_csv(built / "results/tables/summary.csv")
    assert summary["verdict"].tolist() == ["suitable"]
    assert abs(summary["volume_over_winding"].iloc[0] - 1) < 0.2
    defects = pd.read_csv(built / "results/ring/defects.csv").set_index("defect")["count"]
    assert defects["boundary_edges"] == 6


def test_eight_thresholds_are_verified(built):
    verification = pd.read_csv(built / "results/tables/verification.csv")
    assert verification["threshold"].tolist() == [k / 8 for k in range(1, 9)]
    assert (verification["dimension"] == 3).all()
    assert verification["holds"].all()
    for threshold in verification["threshold"]:
        assert (built / f"results/ring/sweep/{threshold}.vtu").is_file()


def test_figures_exports_and_certificate_are_there(built):
    for figure in ("ring/figures/panels", "ring/figures/diagram", "ring/figures/temperature"):
        assert (built / f"results/{figure}.png").stat().st_size > 10_000
    assert (built / "results/figures/pinches.png").stat().st_size > 10_000
    for suffix in ("mesh", "msh", "exo", "inp"):
        assert (built / f"results/ring/export/mesh.{suffix}").stat().st_size > 10_000
    certificate = json.loads((built / "results/ring/certificate.json").read_text())
    assert certificate["measured"] == {"euler": [1, 1, 0], "boundary": [1, 1, 0]}
    command = [sys.executable, "-m", "tusqh", "check", str(built / "results/ring/mesh.vtu")]
    assert subprocess.run(command, capture_output=True).returncode == 0


def test_the_overview_links_to_files_that_are_there(built):
    page = built / "results/report/index.html"
    text = page.read_text()
    assert "1 of 1 models" in text
    links = re.findall(r'(?:href|src)="([^"#][^"]*)"', text)
    assert len(links) > 12
    for link in links:
        assert (page.parent / unquote(link)).is_file(), link
    captions = re.findall(r"<figcaption>(.*?)</figcaption>", text)
    assert "The model, and its mesh at every threshold of the sweep" in " ".join(captions)


def test_snakemakes_own_report_has_captions(repository, built):
    done = snakemake(repository, built, "--report", "report.html")
    assert done.returncode == 0, done.stdout + done.stderr
    text = (built / "report.html").read_text()
    assert len(text) > 500_000
    for caption in ("its mesh at every threshold of the sweep", "Every check of the mesh"):
        assert caption in text


def test_holes_of_a_solid_cannot_be_filled(repository, built):
    config = CONFIG.replace("    unit: mm\n", "    unit: mm\n    holes: {min_cells: 2}\n")
    (built / "other.yaml").write_text(config.replace("ring:", "filled:"))
    done = snakemake(
        repository, built, "results/filled/selection.json", "--configfile", "other.yaml"
    )
    assert done.returncode != 0
    assert "`holes` of a 3D model" in done.stdout + done.stderr
