"""The documentation builds without a warning and without a network, and its examples run."""

import os
import pkgutil
import re
import runpy
import subprocess
import sys

import meshio
import mfem.ser as mfem
import pytest
from drawings import is_drawn

import tusqh
import tusqh.pipeline


def test_the_documentation_builds_strictly_and_loads_nothing_from_elsewhere(repository, tmp_path):
    import mkdocs  # noqa: F401

    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(tmp_path)]
    nowhere = {"http_proxy": "http://127.0.0.1:9", "https_proxy": "http://127.0.0.1:9"}
    done = subprocess.run(
        command, cwd=repository, capture_output=True, text=True, env=os.environ | nowhere
    )
    assert done.returncode == 0, done.stdout + done.stderr
    pages = sorted(tmp_path.rglob("*.html"))
    assert {"index.html", "tutorial.html", "thresholds.html"} <= {page.name for page in pages}
    for page in pages:
        loaded = re.findall(r'<(?:script|img|iframe)[^>]* src="([^"]*)"', page.read_text())
        loaded += re.findall(r'<link[^>]* rel="stylesheet"[^>]* href="([^"]*)"', page.read_text())
        assert not [source for source in loaded if "//" in source], page
    reference = (tmp_path / "reference/python.html").read_text()
    assert "Wanted numbers of components, holes and voids" in reference


#: Serve the command line, the workflow or other modules; nobody calls them from Python.
NOT_IN_THE_REFERENCE = {"__main__", "add_model", "cli", "config", "explorer", "extras"}
NOT_IN_THE_REFERENCE |= {"figures", "hashing", "overview", "settings", "tables"}


def test_every_module_for_users_is_in_the_reference(repository):
    pages = "".join(p.read_text() for p in (repository / "docs/reference").glob("*.md"))
    named = re.findall(r"^::: (tusqh[\w.]*)", pages, re.MULTILINE)
    modules = {m.name for m in pkgutil.iter_modules(tusqh.__path__, "tusqh.")}
    assert {f"tusqh.{name}" for name in NOT_IN_THE_REFERENCE} <= modules
    modules -= {f"tusqh.{name}" for name in NOT_IN_THE_REFERENCE} | {"tusqh.pipeline"}
    modules |= {m.name for m in pkgutil.iter_modules(tusqh.pipeline.__path__, "tusqh.pipeline.")}
    missing = {m for m in modules if not any(f"{n}.".startswith(f"{m}.") for n in named)}
    assert missing == set()


def test_the_first_example_of_the_readme_runs(repository, tmp_path):
    text = (repository / "README.md").read_text()
    (block,) = re.findall(r"<!-- first example -->\n```bash\n(.*?)```", text, re.DOTALL)
    (tmp_path / "data_sources").symlink_to(repository / "data_sources")
    command = block.replace("tusqh ", f"{sys.executable} -m tusqh ", 1)
    done = subprocess.run(command, shell=True, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    (file,) = re.findall(r"-o (\S+)", block)
    n_hexes = len(meshio.read(tmp_path / file).cells_dict["hexahedron"])
    assert mfem.Mesh(str(tmp_path / file), 1, 1).GetNE() == n_hexes > 1000


@pytest.fixture(scope="module")
def drawings(repository):
    """The functions that draw the pictures of the documentation."""
    return runpy.run_path(str(repository / "docs/pictures.py"))["DRAWINGS"]


def test_pictures_are_small_and_show_something(repository, drawings):
    for name in drawings:
        file = repository / f"docs/images/{name}.png"
        assert file.stat().st_size < 400_000, name
        assert is_drawn(file), name


def test_a_picture_can_be_drawn(drawings, tmp_path):
    drawings["curves"]().savefig(tmp_path / "picture.png")
    assert is_drawn(tmp_path / "picture.png")
