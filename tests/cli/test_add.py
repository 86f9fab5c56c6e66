"""`tusqh add` changes both files or neither, and nothing else in them."""

import csv
import sys

import pytest
import trimesh
import yaml

from tusqh.cli.app import main
from tusqh.hashing import hash_file

CONFIG = """# Models of the team.
models:
  plate: &plate   # the first one
    geometry: data_sources/plate.svg
    grid: {cells: 12}   # coarse

  plate_fine:
    <<: *plate
    grid: {cells: 24}
  # a comment at the end of the models

# How many steps.
snapshots: [0, 1, 2, 3, 4, 5]
"""
REGISTER = """model,file,available,origin,url,licence,sha256,known_defects
plate,data_sources/plate.svg,yes,drawn here,,BSD-3-Clause,00,none
"""


@pytest.fixture
def project(tmp_path):
    """Return a small repository beside a folder with a part."""
    root = tmp_path / "project"
    for folder in ("config", "data_sources"):
        (root / folder).mkdir(parents=True)
    (root / "config/config.yaml").write_text(CONFIG)
    (root / "data_sources/register.csv").write_text(REGISTER)
    box = trimesh.creation.box()
    box.update_faces([k > 0 for k in range(len(box.faces))])
    box.export(tmp_path / "part.stl")
    return root


@pytest.fixture
def add(project, capfd, monkeypatch):
    """Run `tusqh add` in the repository; return exit code, output and errors."""

    def add(*arguments):
        monkeypatch.setattr(sys, "argv", ["tusqh", "add", *map(str, arguments)])
        monkeypatch.setattr("tusqh.cli.app.catch_signals", lambda: None)
        monkeypatch.chdir(project)
        try:
            main()
            code = 0
        except SystemExit as end:
            code = end.code
        out, err = capfd.readouterr()
        assert "Traceback" not in err
        return code, out, err

    return add


def contents(project):
    return {p: p.read_bytes() for p in sorted(project.rglob("*")) if p.is_file()}


def test_a_model_is_added_and_comments_stay(project, add):
    part = project.parent / "part.stl"
    options = ("--name", "bracket", "--betti", "1,0..2", "--unit", "mm", "--licence", "CC0-1.0")
    code, out, err = add(part, *options)
    assert code == 0, err
    text = (project / "config/config.yaml").read_text()
    block = (
        "\n  bracket:\n    geometry: data_sources/bracket/part.stl\n"
        "    grid: {cells: 64, placement: auto}\n    unit: mm\n"
        "    target: {betti_0: 1, betti_1: {max: 2, min: 0}}\n"
    )
    assert block in text
    assert text.replace(block, "") == CONFIG
    config = yaml.safe_load(text)
    assert list(config["models"]) == ["plate", "plate_fine", "bracket"]
    assert config["snapshots"] == [0, 1, 2, 3, 4, 5]
    rows = list(csv.DictReader((project / "data_sources/register.csv").open()))
    assert (project / "data_sources/register.csv").read_text().startswith(REGISTER)
    copied = project / "data_sources/bracket/part.stl"
    assert copied.read_bytes() == part.read_bytes()
    assert rows[-1]["model"] == "bracket"
    assert rows[-1]["file"] == "data_sources/bracket/part.stl"
    assert rows[-1]["licence"] == "CC0-1.0"
    assert rows[-1]["sha256"] == hash_file(part)
    assert rows[-1]["known_defects"] == "3 boundary edges, 3 unbalanced edges"
    assert "snakemake --cores 2 results/bracket" in out


def test_files_inside_and_in_packages_are_not_copied(project, add):
    inside = project / "data_sources/box.stl"
    inside.write_bytes((project.parent / "part.stl").read_bytes())
    assert add(inside, "--cells", 8)[0] == 0
    package = "package:pyvista/examples/airplane.ply"
    code, _, err = add(package, "--name", "plane", "--match-volume")
    assert code == 0, err
    models = yaml.safe_load((project / "config/config.yaml").read_text())["models"]
    assert models["box"] == {"geometry": "data_sources/box.stl", "grid": {"cells": 8}}
    assert models["plane"]["geometry"] == package
    assert models["plane"]["volume"] == "match"
    assert not (project / "data_sources/plane").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["../part.stl", "--name", "plate"], "'plate' has the same name"),
        (["../part.stl", "--name", "PLATE"], "'plate' has the same name"),
        (["../part.stl", "--name", "a<script>"], "is not a plain file name"),
        (["../part.stl", "--name", "../up"], "is not a plain file name"),
        (["../part.stl", "--name", "tables"], "is reserved"),
        (["../part.stl", "--threshold", "7"], "above 0 and at most 1"),
        (["../part.stl", "--betti", "1", "--threshold", "0.5"], "both are given"),
        (["../none.stl"], "no such file"),
        (["../part.stl", "--config", "config/other.yaml"], "cannot be read"),
    ],
)
def test_mistakes_change_nothing(project, add, arguments, message):
    before = contents(project)
    code, _, err = add(*arguments)
    assert code == 2
    assert message in err
    assert contents(project) == before


def test_the_same_model_twice_is_refused(project, add):
    assert add("../part.stl", "--name", "a")[0] == 0
    before = contents(project)
    assert "has the same name" in add("../part.stl", "--name", "a")[2]
    inside = "data_sources/a/part.stl"
    assert "'a' has the same block" in add(inside, "--name", "b")[2]
    register = project / "data_sources/register.csv"
    register.write_text(register.read_text() + "c,,no,x,,x,,\n")
    assert "has a row already" in add("../part.stl", "--name", "c")[2]
    register.write_bytes(before[register])
    assert contents(project) == before


def test_a_configuration_in_another_style_is_left_alone(project, add):
    config = project / "config/config.yaml"
    config.write_text("models: {plate: {geometry: data_sources/plate.svg}}\n")
    before = contents(project)
    assert "write the first model by hand" in add("../part.stl")[2]
    assert contents(project) == before


def test_nothing_is_half_written_when_the_register_cannot_be(project, add):
    (project / "data_sources/register.csv").unlink()
    (project / "data_sources").rmdir()
    (project / "data_sources").write_text("a file in the way")
    before = contents(project)
    code, _, err = add("../part.stl")
    assert code == 2
    assert "cannot be written" in err
    assert contents(project) == before


def test_the_committed_configuration_takes_a_model(repository, project, add):
    """The real file is used, with its anchors and comments."""
    text = (repository / "config/config.yaml").read_text()
    (project / "config/config.yaml").write_text(text)
    assert add("../part.stl", "--name", "part")[0] == 0
    after = (project / "config/config.yaml").read_text()
    # The block follows the last model, and nothing else changes.
    models, study = text.split("\n# The programs that Tusqh is compared with")
    assert after.startswith(models.rstrip("\n"))
    assert after.endswith(study)
    assert list(yaml.safe_load(after)["models"])[-1] == "part"
