"""The recommended grid has the topology at other places too, and its command makes the mesh."""

import shlex

import numpy as np
import pytest
import trimesh
from typer.testing import CliRunner

import tusqh
from tusqh.cli.app import app
from tusqh.errors import ConfigError
from tusqh.pipeline.ingest import ingest
from tusqh.pipeline.recommend import _common, recommend
from tusqh.settings.goal import Target
from tusqh.settings.model import Settings


def torus():
    made = trimesh.creation.torus(1.0, 0.4, major_sections=24, minor_sections=12)
    return np.asarray(made.vertices), np.asarray(made.faces)


def plate_with_hole():
    plate = trimesh.creation.box(bounds=[[0, 0, 0], [48, 32, 8]])
    hole = trimesh.creation.cylinder(radius=7, height=8, sections=24)
    hole.apply_translation([24, 16, 4])
    hole.invert()
    part = trimesh.util.concatenate([plate, hole])
    return np.asarray(part.vertices), np.asarray(part.faces)


@pytest.mark.parametrize("part", [torus, plate_with_hole])
def test_the_topology_holds_at_places_that_were_not_tried(part):
    found = recommend(ingest(part()), Target(betti_0=1, betti_1=1, betti_2=0))
    chosen = found.table[found.table["cells"] == found.cells].iloc[0]
    assert chosen["is_robust"]
    rng = np.random.default_rng(0)
    for offset in rng.uniform(0, 0.999, (6, 3)):
        result = tusqh.mesh(
            part(), cells=found.cells, offset=offset.tolist(), threshold=chosen["threshold"]
        )
        assert tuple(result.report.measured) == (1, 1, 0)
    coarser = found.table[found.table["cells"] < found.cells]
    assert not (coarser["is_robust"] & coarser["is_robust"].shift(-1, fill_value=False)).any()


@pytest.mark.parametrize("extra", [[], ["--snap"]])
def test_the_printed_command_makes_the_mesh(tmp_path, extra):
    vertices, faces = plate_with_hole()
    path = tmp_path / "plate.stl"
    trimesh.Trimesh(vertices, faces, process=False).export(path)
    run = CliRunner()
    done = run.invoke(app, ["recommend", str(path), "--betti", "1,1,0", *extra])
    assert done.exit_code == 0, done.output
    assert "Grids tried for betti_0 = 1" in done.output
    words = shlex.split(done.output.strip().splitlines()[-1])
    assert words[:2] == ["tusqh", "mesh"]
    assert ("--snap" in words) == bool(extra)
    made = run.invoke(app, [*words[1:], "-o", str(tmp_path / "mesh.vtu"), "--json"])
    assert '"met": true' in made.output, made.output
    assert '"changed_cells": 0' in made.output


def test_what_no_grid_has_is_said(tmp_path):
    path = tmp_path / "ring.stl"
    trimesh.Trimesh(*torus()).export(path)
    done = CliRunner().invoke(app, ["recommend", str(path), "--betti", "3,0,0", "--finest", "10"])
    assert done.exit_code == 1
    assert "no grid that was tried" in done.output + str(done.stderr)
    with pytest.raises(ConfigError, match="no topology"):
        recommend(ingest(torus()), None)


def test_outlines_and_images_too():
    points = np.array([[0, 0], [3, 0], [3, 3], [0, 3], [1, 1], [1, 2], [2, 2], [2, 1]])
    lines = np.array([[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4]])
    frame = recommend(ingest((points, lines)), Target(betti_0=1, betti_1=1))
    assert frame.cells == 6
    assert frame.two_cells == pytest.approx(0.5)
    voxels = np.ones((12, 12, 12), dtype=np.uint8)
    voxels[4:8, 4:8, :] = 0
    image = recommend(ingest(voxels), Target(betti_0=1, betti_1=1, betti_2=0))
    assert set(image.table["positions"]) == {1}
    assert image.cells == 6  # Two voxels a cell: every fraction is 0 or 1.


def test_settings_are_kept_in_the_command():
    settings = Settings.from_dict({"rule": "clamped", "grid": {"rotate": [0, 0, 30]}})
    found = recommend(ingest(torus()), Target(betti_1=1), settings)
    text = shlex.join(found.words)
    assert "--rotate 0,0,30" in text
    assert "--rule clamped" in text


def test_the_common_interval_is_in_one_of_each_position():
    assert _common([[(0.1, 0.4), (0.45, 0.7)], [(0.2, 0.6)]]) == (0.45, 0.6)  # It has 1/2.
    assert _common([[(0.1, 0.3), (0.6, 0.7)], [(0.1, 0.65)]]) == (0.1, 0.3)
    assert _common([[(0.1, 0.4), (0.4, 0.7)], [(0.1, 0.6)]]) == (0.4, 0.6)
    assert np.isnan(_common([[(0.1, 0.2)], [(0.3, 0.4)]])).all()
    assert np.isnan(_common([[], [(0.3, 0.4)]])).all()
