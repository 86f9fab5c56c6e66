"""The workflow, the Python call and the command line give one answer for an image of voxels."""

import json
import subprocess
import sys

import meshio
import numpy as np
import pandas as pd
import pytest
import tifffile
from drawings import is_drawn
from needs import require_rendering
from workflow_runs import succeed

import tusqh
from tusqh.explorer.materials import make_materials_page, read_materials_subject
from tusqh.hashing import hash_file

CONFIG = """models:
  foam:
    geometry: foam.tif
    unit: um
    image: {voxel_size: 4.5, empty: 30, full: 210}
    grid: {cells: 12}
    domain: outside
    target: {betti_0: 1}
    components: {min_cells: 3}
  grains:
    geometry: grains.npy
    labels: {1: bone, 2: marrow}
    grid: {cells: 6}
snapshots: [0, 2, 4, 8, 16, 32]
"""


@pytest.fixture(scope="module")
def foam(tmp_path_factory):
    """Return a foam of random bubbles in noisy grey values, and the results of the workflow."""
    require_rendering()
    folder = tmp_path_factory.mktemp("foam")
    rng = np.random.default_rng(7)
    at = np.stack(np.meshgrid(*[np.arange(24.0)] * 3, indexing="ij"), axis=-1)
    distance = np.min(
        [np.linalg.norm(at - c, axis=-1) for c in rng.uniform(0, 24, (30, 3))], axis=0
    )
    grey = 30 + 180 * np.clip(distance - 5, 0, 1) + rng.normal(0, 4, distance.shape)
    tifffile.imwrite(folder / "foam.tif", np.clip(grey, 0, 255).astype(np.uint8).transpose())
    np.save(folder / "grains.npy", rng.integers(0, 3, (6, 6, 6)).astype(np.uint8))
    (folder / "config").mkdir()
    (folder / "config/config.yaml").write_text(CONFIG)
    files = ("verdict.csv", "figures/panels.png", "defects.csv")
    of_grains = ("certificate.json", "export/mesh.exo", "explorer.html")
    targets = [f"results/foam/{file}" for file in files]
    succeed(folder, *targets, *(f"results/grains/{file}" for file in of_grains))
    return folder


def test_the_workflow_meshes_the_pores(foam):
    facts = json.loads((foam / "results/foam/facts.json").read_text())
    assert facts["grid"] == "12x12x12"
    assert facts["cell_size"] == 9
    assert facts["betti_measured"] == facts["betti_predicted"]
    assert facts["betti_measured"][0] == 1
    verdict = pd.read_csv(foam / "results/foam/verdict.csv")
    assert not (verdict["holds"] == "no").any()
    defects = pd.read_csv(foam / "results/foam/defects.csv").set_index("defect")
    assert defects["count"]["voxels"] == 24**3
    pores = defects["measure"]["voxels"] - defects["measure"]["material_voxels"]
    assert facts["winding_volume"] == pytest.approx(pores, rel=1e-5)
    assert is_drawn(foam / "results/foam/figures/panels.png")


def test_the_python_call_gives_the_same_files(foam):
    result = tusqh.mesh(
        foam / "foam.tif",
        unit="um",
        image={"voxel_size": 4.5, "empty": 30, "full": 210},
        cells=12,
        domain="outside",
        betti=(1,),
        components={"min_cells": 3},
    )
    result.save(foam / "saved")
    for file in (foam / "saved").iterdir():
        assert hash_file(file) == hash_file(foam / "results/foam" / file.name), file.name


def test_the_command_line_gives_the_same_mesh(foam):
    options = "--unit um --voxel-size 4.5 --empty 30 --full 210 --cells 12 --domain outside "
    options += "--min-cells 3"
    command = [sys.executable, "-m", "tusqh", "mesh", "foam.tif", *options.split()]
    done = subprocess.run(
        [*command, "--betti", "1", "-o", "foam.vtu"], cwd=foam, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert hash_file(foam / "foam.vtu") == hash_file(foam / "results/foam/mesh.vtu")


def test_several_materials_are_meshed_in_one_step(foam):
    result = tusqh.mesh(
        foam / "grains.npy", cells=6, materials={1: "bone", 2: "marrow"}, name="grains"
    )
    assert result.is_as_predicted
    result.save(foam / "grains")
    files = sorted(path.name for path in (foam / "grains").iterdir())
    assert {"certificate.json", "materials.csv", "mesh.vtu", "pairs.csv"} <= set(files)
    for file in files:
        assert hash_file(foam / "grains" / file) == hash_file(foam / "results/grains" / file), file
    result.write(foam / "grains.exo")
    written = [foam / "grains.exo", foam / "results/grains/export/mesh.exo"]
    blocks = [[len(b.data) for b in meshio.read(path).cells] for path in written]
    assert blocks[0] == blocks[1]
    page = make_materials_page(read_materials_subject(foam / "grains", geometry="grains.npy"))
    assert page == (foam / "results/grains/explorer.html").read_text("utf-8")
    rows = pd.read_csv(foam / "results/grains/verification.csv")
    assert rows["material"].tolist() == ["bone", "marrow", "all"]
    assert rows["holds"].all()
