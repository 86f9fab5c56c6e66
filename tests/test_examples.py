"""The examples run unchanged, and their results agree with their first paragraph."""

import importlib.util
import subprocess
import sys

import pytest

from tusqh.meshes.betti import betti_by_boundary
from tusqh.meshes.export import read_vtu


@pytest.fixture
def example(repository):
    """Import an example by its name."""

    def load(name):
        spec = importlib.util.spec_from_file_location(name, repository / f"examples/{name}.py")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module

    return load


def test_the_bearing_is_three_rings(example, tmp_path):
    plain, apart = example("bearing").main(tmp_path)
    assert plain.report.measured == (1, 15, 0)
    assert apart.report.measured == (3, 3, 0) == betti_by_boundary(read_vtu(tmp_path / "mesh.vtu"))
    assert apart.report.is_suitable
    assert (tmp_path / "bearing.inp").is_file()


def test_the_stack_is_one_body_of_sand(example, tmp_path):
    result = example("porous_stack").main(tmp_path)
    assert result.report.measured == (1, 0, 0) == betti_by_boundary(result.mesh)
    assert result.report.is_suitable
    assert len(result.built.resolved.cells.features) > 3
    assert (tmp_path / "certificate.json").is_file()


def test_the_map_has_eight_islands(example, tmp_path):
    plain, eight = example("shapefile_map").main(tmp_path)
    assert plain.report.measured.betti_0 == 7
    assert eight.report.measured == (8, 0, 0) == betti_by_boundary(eight.mesh)
    assert eight.report.is_suitable


def test_an_example_runs_from_anywhere(repository, tmp_path):
    command = [sys.executable, str(repository / "examples/porous_stack.py")]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "Betti numbers (1, 0, 0), as predicted" in done.stdout
    assert (tmp_path / "sand/mesh.vtu").is_file()
