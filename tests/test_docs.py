"""The documentation builds without a warning and without a network, and its examples run."""

import html
import os
import re
import runpy
import subprocess
import sys
import zlib
from importlib import import_module

import meshio
import mfem.ser as mfem
import pytest
from drawings import is_drawn

import tusqh


@pytest.fixture(scope="module")
def site(repository, tmp_path_factory):
    """Return the documentation, built without a warning."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder)]
    nowhere = {"http_proxy": "http://127.0.0.1:9", "https_proxy": "http://127.0.0.1:9"}
    done = subprocess.run(
        command, cwd=repository, capture_output=True, text=True, env=os.environ | nowhere
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


def test_the_documentation_loads_nothing_from_elsewhere(site):
    pages = sorted(site.rglob("*.html"))
    assert {"index.html", "tutorial.html", "thresholds.html"} <= {page.name for page in pages}
    for page in pages:
        loaded = re.findall(r'<(?:script|img|iframe)[^>]* src="([^"]*)"', page.read_text())
        loaded += re.findall(r'<link[^>]* rel="stylesheet"[^>]* href="([^"]*)"', page.read_text())
        assert not [source for source in loaded if "//" in source], page


def text_of(page):
    """Return the words of a built page without its markup."""
    return html.unescape(re.sub(r"<[^>]+>", "", page.read_text()))


def test_every_module_is_in_the_reference(repository, site):
    inventory = (site / "objects.inv").read_bytes().split(b"\n", 4)[4]
    entries = zlib.decompress(inventory).decode().splitlines()
    described = {line.split()[0] for line in entries if " py:module " in line}
    files = [p.relative_to(repository) for p in (repository / "tusqh").rglob("*.py")]
    modules = {".".join(p.with_suffix("").parts).removesuffix(".__init__") for p in files}
    assert len(modules) > 80
    missing = {name for name in modules - described if not name.endswith("__main__")}
    assert missing == {"tusqh"}


def test_the_page_of_examples_shows_the_examples(repository, site):
    page = text_of(site / "examples.html")
    examples = sorted((repository / "examples").glob("*.py"))
    assert examples
    for example in examples:
        (line,) = re.findall(r"^def main.*$", example.read_text(), re.MULTILINE)
        assert page.count(line) >= 1, example
    assert "--8" not in page


def test_citations_of_the_algorithm_lead_to_a_section(repository):
    text = (repository / "docs/algorithm.md").read_text()
    sections = set(re.findall(r"^#+ ([\d.]*\d)\.? ", text, re.MULTILINE))
    files = [*(repository / "tusqh").rglob("*.py"), *(repository / "studies").rglob("*.py")]
    cited = {p: re.findall(r"\b[Aa]lgorithm (\d[\d.]*\d|\d)", p.read_text()) for p in files}
    assert sum(map(len, cited.values())) > 5
    assert {number for numbers in cited.values() for number in numbers} <= sections


def test_every_public_module_has_a_list_of_its_names(repository):
    page = (repository / "docs/public.md").read_text()
    named = set(re.findall(r"`(tusqh\.[a-z_.]+)`\]\[\]", page)) | set(tusqh._MODULES.values())
    assert {"tusqh.errors", "tusqh.pipeline.mesh"} <= named
    for name in named:
        module = import_module(name)
        assert set(module.__all__) <= set(dir(module)), name
    assert all(f"`{name}`" in page for name in set(tusqh.__all__) - {"__version__"})


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
    """Return the functions that draw the pictures of the documentation."""
    return runpy.run_path(str(repository / "docs/pictures.py"))["DRAWINGS"]


def test_pictures_are_small_and_show_something(repository, drawings):
    assert drawings
    for name in [*drawings, "rules"]:
        file = repository / f"docs/images/{name}.png"
        assert file.stat().st_size < 400_000, name
        assert is_drawn(file), name


def test_a_picture_can_be_drawn(drawings, tmp_path):
    drawings["curves"]().savefig(tmp_path / "picture.png")
    assert is_drawn(tmp_path / "picture.png")
