"""`tusqh mesh` and `tusqh inspect` print what was read, left out or changed."""

import json
import sys

import pytest
import trimesh

from tusqh.cli.app import main

LINE_LEFT_OUT = "left out: 1 lines beside polygons"


@pytest.fixture
def run(tmp_path, capfd, monkeypatch):
    """Run `tusqh` in a separate folder; return its output with single spaces."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tusqh.cli.app.catch_signals", lambda: None)

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["tusqh", *map(str, arguments)])
        with pytest.raises(SystemExit):
            main()
        return " ".join(capfd.readouterr().out.split())

    return run


@pytest.fixture
def road_loop(repository):
    return next((repository / "tests/cases").glob("*/road_loop.geojson"))


def test_mesh_prints_what_the_reader_left_out(run, road_loop):
    assert f"remark 1 {LINE_LEFT_OUT}" in run("mesh", road_loop, "--cells", 12, "-o", "x.vtu")


def test_the_json_report_has_the_remarks(run, road_loop):
    text = run("mesh", road_loop, "--cells", 12, "-o", "x.vtu", "--json")
    assert json.loads(text)["remarks"][0].startswith(LINE_LEFT_OUT)


def test_inspect_prints_what_the_reader_left_out(run, road_loop):
    assert LINE_LEFT_OUT in run("inspect", road_loop, "--defects-only")


def test_mesh_names_the_parts_that_it_turned(run, repository):
    part = next((repository / "tests/cases").glob("*/u15_small_inverted.stl"))
    assert "1 parts turned that point inwards: part 2" in run(
        "mesh", part, "--cells", 20, "-o", "x.vtu"
    )


@pytest.fixture
def bar(tmp_path):
    """Return a box of 1 x 2 x 3, as text STL."""
    path = tmp_path / "bar.stl"
    trimesh.creation.box((1, 2, 3)).apply_translation((0.5, 1, 1.5)).export(
        path, file_type="stl_ascii"
    )
    return path


READ = "read STL: 1 part, 12 triangles, 8 points, closed"
BOX, UNIT = "box (0, 0, 0) to (1, 2, 3)", "unit not stated"


def test_mesh_says_in_three_lines_what_was_read(run, bar):
    text = run("mesh", bar, "--cells", 6, "-o", "x.vtu")
    assert text.startswith(f"{READ} {BOX} {UNIT} wanted")


def test_inspect_says_the_same(run, bar):
    assert run("inspect", bar, "--defects-only").startswith(f"{READ} {BOX} {UNIT} Defects")


def test_what_was_read_is_saved_beside_the_mesh(run, road_loop, tmp_path):
    run("mesh", road_loop, "--cells", 12, "-o", "x.vtu", "--results", "all")
    stored = json.loads((tmp_path / "all/reading.json").read_text())
    assert stored["format"] == "GeoJSON"
    assert stored["closed"] is True
    assert stored["remarks"][0]["count"] == 1
    assert stored["counts"]["open_ends"] == 0
