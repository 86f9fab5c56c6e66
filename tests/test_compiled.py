"""Functions are compiled once after an installation, before several processes need them."""

import os
import subprocess
import sys

import pytest

from tusqh import compiled

MESHES = """
from numba.core import event
import tusqh

compiled = []

class Listener(event.Listener):
    def on_start(self, event):
        compiled.append(event.data["dispatcher"].py_func.__module__)

    def on_end(self, event):
        pass

with event.install_listener("numba:compile", Listener()):
    for source in ("data_sources/solids/torus.stl", "data_sources/analytic/gap.svg"):
        result = tusqh.mesh(source, cells=12)
        result.diagram, result.defects, result.prices
assert not [module for module in compiled if module.startswith("tusqh.")], compiled
"""


def test_numbas_own_folder_counts_as_compiled(monkeypatch, tmp_path):
    monkeypatch.setattr(compiled, "__file__", str(tmp_path / "compiled.py"))
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    assert not compiled.is_compiled()
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert compiled.is_compiled()


def test_files_beside_the_modules_count_as_compiled(monkeypatch, tmp_path):
    monkeypatch.setattr(compiled, "__file__", str(tmp_path / "compiled.py"))
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    (tmp_path / "sampling/__pycache__").mkdir(parents=True)
    (tmp_path / "sampling/__pycache__/angles._wind-73.py311.nbi").touch()
    assert compiled.is_compiled()


def test_a_failure_of_one_process_is_an_error(monkeypatch):
    monkeypatch.setattr(compiled, "_SHARES", ("no such share", "no such share"))
    with pytest.raises(subprocess.CalledProcessError):
        compiled.compile_functions()


@pytest.mark.slow
def test_meshing_compiles_nothing_afterwards(monkeypatch, tmp_path, repository):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    compiled.compile_functions()
    command = [sys.executable, "-W", "ignore", "-c", MESHES]
    subprocess.run(command, cwd=repository, env=os.environ, check=True)
