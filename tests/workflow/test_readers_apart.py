"""A change in one reader reruns the models in its format and no others."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import trimesh

from provenance.code import code_files

CONFIG = """models:
  plate:
    geometry: plate.svg
    grid: {cells: 8}
  part:
    geometry: part.stl
    grid: {cells: 8}
"""
TARGETS = ["results/plate/fractions.npz", "results/part/fractions.npz"]


@pytest.fixture
def checkout(repository, tmp_path):
    """A copy of the checkout, with compiled functions, whose code may be edited."""
    folder = tmp_path / "checkout"
    for name in ("tusqh", "studies", "provenance", "workflow"):
        shutil.copytree(repository / name, folder / name)
    for path in filter(Path.is_file, repository.iterdir()):
        shutil.copy2(path, folder)
    return folder


def snakemake(checkout, folder, *arguments):
    command = [sys.executable, "-m", "snakemake", "-s", str(checkout / "Snakefile")]
    done = subprocess.run(
        [*command, "--cores", "1", *arguments, "--", *TARGETS],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(checkout)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


def planned(checkout, folder):
    """Rules with the models that a dry run would run them for."""
    text = snakemake(checkout, folder, "--dry-run")
    jobs = re.findall(r"rule (\w+):.*?wildcards: model=(\w+)", text, re.DOTALL)
    return set(jobs)


def edit(path, old, new):
    text = path.read_text()
    assert text.count(old) == 1
    path.write_text(text.replace(old, new))


def test_a_change_in_one_reader_reruns_the_models_in_its_format(checkout, tmp_path):
    folder = tmp_path / "work"
    (folder / "config").mkdir(parents=True)
    (folder / "config/config.yaml").write_text(CONFIG)
    (folder / "plate.svg").write_text("<svg><rect width='4' height='3'/></svg>")
    trimesh.creation.box((1, 2, 3)).export(folder / "part.stl")
    snakemake(checkout, folder)
    assert planned(checkout, folder) == set()
    edit(checkout / "tusqh/readers/svg.py", "not <svg>", "but not <svg>")
    assert planned(checkout, folder) == {("ingest", "plate"), ("sample", "plate")}
    edit(checkout / "tusqh/readers/stl.py", "a complete STL file", "an undamaged STL file")
    assert ("ingest", "part") in planned(checkout, folder)


def test_no_step_after_ingest_runs_a_reader(repository):
    scripts = sorted((repository / "workflow/scripts").glob("*.py"))
    assert len(scripts) > 20
    for script in scripts:
        name = f"workflow/scripts/{script.name}"
        readers = {f for f in code_files(name, base=repository) if "tusqh/readers/" in f}
        formats = {f for f in readers if f.removeprefix("tusqh/readers/") in ("svg.py", "stl.py")}
        assert not formats, script.name
        if script.name in ("sample.py", "select.py", "mesh.py", "figure_field.py", "sweep.py"):
            assert not readers, script.name
