"""The core can mesh without the libraries of the extras."""

import re
import subprocess
import sys
import tomllib

import meshio
import pytest
import yaml

import tusqh

#: The packages that the extras install, by the names under which they are imported.
OPTIONAL = (
    *("PIL", "ezdxf", "igl", "jinja2", "matplotlib", "mfem", "nrrd", "netCDF4", "pymeshlab"),
    *(
        "pyvista",
        "seaborn",
        "shapefile",
        "snakemake",
        "svgpathtools",
        "tabulate",
        "tifffile",
        "vtk",
    ),
    "vtkmodules",
)

#: Runs a command of tusqh in a process in which the optional libraries cannot be imported.
WITHOUT_EXTRAS = f"""
import sys

class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {OPTIONAL!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)

sys.meta_path.insert(0, Blocked())
from tusqh.cli.app import main
main()
"""


def run_without_extras(*arguments):
    command = [sys.executable, "-c", WITHOUT_EXTRAS, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True)


def test_the_core_meshes_an_stl_file(repository, tmp_path):
    torus, mesh = repository / "data_sources/solids/torus.stl", tmp_path / "torus.vtu"
    done = run_without_extras("mesh", torus, "--cells", 16, "--betti", "1,1,0", "-o", mesh)
    assert done.returncode == 0, done.stderr
    assert "as predicted" in done.stdout
    assert re.search(r"suitable \(\d+ not run\)", done.stdout)
    assert len(meshio.read(mesh).cells_dict["hexahedron"]) > 100


BEGINNINGS = {
    "outline.svg": b"<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0H1V1Z'/></svg>",
    "outline.dxf": b"  0\nSECTION\n  2\nHEADER\n",
    "map.shp": b"\0\0\x27\x0a",
    "stack.tif": b"II*\0",
    "ct.nrrd": b"NRRD0004\n",
}


@pytest.mark.parametrize("name", BEGINNINGS)
def test_a_missing_extra_is_an_error_that_names_it(tmp_path, name):
    path = tmp_path / name
    path.write_bytes(BEGINNINGS[name].ljust(200, b"\0" if name != "outline.svg" else b" "))
    for suffix in (".dbf", ".shx"):
        path.with_suffix(suffix).touch()
    done = run_without_extras("mesh", path, "-o", tmp_path / "mesh.vtu")
    assert done.returncode == 2
    assert 'pip install "tusqh[formats]"' in done.stderr
    assert "Traceback" not in done.stderr


def test_writing_exodus_names_its_extra(repository, tmp_path):
    torus, mesh = repository / "data_sources/solids/torus.stl", tmp_path / "torus.exo"
    done = run_without_extras("mesh", torus, "--cells", 12, "-o", mesh)
    assert done.returncode == 2
    assert 'pip install "tusqh[formats]"' in done.stderr
    assert not mesh.exists()


@pytest.mark.slow
def test_a_bare_installation_meshes_an_stl_file(repository, tmp_path):
    python = tmp_path / "venv/bin/python"
    subprocess.run([sys.executable, "-m", "venv", tmp_path / "venv"], check=True)
    subprocess.run([python, "-m", "pip", "install", "-q", repository], check=True)
    installed = subprocess.run([python, "-m", "pip", "freeze"], capture_output=True, text=True)
    assert not re.search("^(vtk|mfem|pymeshlab|snakemake)=", installed.stdout, re.MULTILINE)
    mesh = tmp_path / "torus.vtu"
    command = [python, "-m", "tusqh", "mesh", repository / "data_sources/solids/torus.stl"]
    done = subprocess.run([*command, "--cells", "16", "-o", mesh], cwd=tmp_path)
    assert done.returncode == 0
    assert len(meshio.read(mesh).cells_dict["hexahedron"]) > 100


def test_the_version_has_one_home(repository):
    project = tomllib.loads((repository / "pyproject.toml").read_text())["project"]
    assert "version" in project["dynamic"]
    citation = yaml.safe_load((repository / "CITATION.cff").read_text())
    assert citation["version"] == tusqh.__version__
    done = subprocess.run(
        [sys.executable, "-m", "tusqh", "--version"], capture_output=True, text=True
    )
    assert done.stdout == f"tusqh {tusqh.__version__}\n"
    assert f"## [{tusqh.__version__}]" in (repository / "CHANGELOG.md").read_text()
