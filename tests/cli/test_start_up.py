"""What starting the command line and importing the package loads: counted, since times vary."""

import json
import subprocess
import sys

import pytest

#: Libraries that take longer to import than the help takes to print.
SLOW = {"gudhi", "igl", "jsonschema", "matplotlib", "meshio", "mfem", "numba", "numpy", "pandas"}
SLOW |= {"pymeshlab", "pyvista", "scipy", "shapely", "trimesh", "vtk", "vtkmodules", "yaml"}

HELP = """
import sys
from tusqh.cli.app import main
sys.argv = ["tusqh", *{words!r}]
try:
    main()
except SystemExit as end:
    assert end.code == 0
"""


def loaded(code):
    """Return the top-level packages that a fresh interpreter has loaded after some code."""
    code += "\nimport json, sys\nsys.stderr.write(json.dumps(sorted(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return {name.partition(".")[0] for name in json.loads(done.stderr)}


def test_importing_the_package_loads_no_library():
    assert not SLOW & loaded("import tusqh")


@pytest.mark.parametrize("words", [["--help"], ["--version"], ["mesh", "--help"]])
def test_help_loads_no_slow_library(words):
    assert not SLOW & loaded(HELP.format(words=words))
