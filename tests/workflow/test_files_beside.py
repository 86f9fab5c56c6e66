"""Files beside a geometry file are inputs of the steps that read it; pictures pass all steps."""

import json

import numpy as np
import pytest
import shapefile
from PIL import Image as Pillow
from workflow_runs import succeed

CONFIG = """models:
  lot:
    geometry: lot.shp
    grid: {cells: 8}
  cut:
    geometry: cut.png
    unit: mm
    image: {voxel_size: 0.5}
    grid: {cells: 20}
    target: {betti_0: 1, betti_1: 1}
    fit: true
snapshots: [0, 2, 4, 8, 16, 32]
"""
SYSTEM = 'PROJCS["flat",GEOGCS["any",UNIT["Degree",0.017]],UNIT["{unit}",{size}]]'


@pytest.fixture
def project(tmp_path):
    (tmp_path / "config").mkdir()
    (tmp_path / "config/config.yaml").write_text(CONFIG)
    with shapefile.Writer(str(tmp_path / "lot"), shapeType=shapefile.POLYGON) as writer:
        writer.field("n", "N")
        writer.poly([[[0, 0], [0, 300], [400, 300], [400, 0], [0, 0]]])
        writer.record(1)
    (tmp_path / "lot.prj").write_text(SYSTEM.format(unit="Meter", size=1))
    y, x = np.mgrid[0:30, 0:40]
    distance = np.hypot(x - 19.5, y - 14.5)
    Pillow.fromarray(np.uint8(255 * ((distance < 14) & (distance > 5)))).save(tmp_path / "cut.png")
    return tmp_path


@pytest.mark.slow
def test_a_file_beside_a_geometry_is_an_input(project):
    target = "results/lot/geometry.vtp"
    succeed(project, "--", target)
    reading = json.loads((project / "results/lot/reading.json").read_text())
    assert reading["unit"]["name"] == "m"
    records = [json.loads(p.read_text()) for p in (project / "results").rglob("*.json")]
    inputs = [r["inputs"] for r in records if isinstance(r, dict) and r.get("inputs")]
    assert any("lot.prj" in {row["path"] for row in rows} for rows in inputs)
    assert "ingest" not in succeed(project, "--dry-run", "--", target)
    (project / "lot.prj").write_text(SYSTEM.format(unit="Foot_US", size=0.3048006))
    assert "ingest" in succeed(project, "--dry-run", "--", target)
    succeed(project, "--", target)
    reading = json.loads((project / "results/lot/reading.json").read_text())
    assert reading["unit"]["name"] == "us-ft"


@pytest.mark.slow
def test_a_picture_passes_all_steps(project):
    names = ("field", "thresholds", "antialias", "fit")
    targets = [f"results/cut/figures/{name}.png" for name in names]
    succeed(project, "--", *targets, "results/cut/verdict.csv", "results/cut/explorer.html")
    for target in targets:
        with Pillow.open(project / target) as picture:
            assert len(np.unique(np.asarray(picture.convert("L")))) > 20
