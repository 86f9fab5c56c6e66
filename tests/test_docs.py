"""The documentation builds without a warning and without a network, and its examples run."""

import os
import re
import subprocess
import sys

import meshio
import mfem.ser as mfem


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


def test_every_module_is_in_the_reference(repository):
    pages = "".join(p.read_text() for p in (repository / "docs/reference").glob("*.md"))
    named = re.findall(r"^::: (tusqh[\w.]*)", pages, re.MULTILINE)
    for package in (
        "geometry",
        "readers",
        "sampling",
        "topology",
        "antialias",
        "threshold",
        "meshes",
    ):
        assert f"tusqh.{package}" in named
    stages = sorted(p.stem for p in (repository / "tusqh/pipeline").glob("*.py"))
    for stage in stages:
        assert stage == "__init__" or any(n.startswith(f"tusqh.pipeline.{stage}") for n in named)


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


def test_pictures_are_small_and_can_be_drawn(repository):
    pictures = (repository / "docs/pictures.py").read_text()
    for name in re.findall(r'^    "(\w+)": draw_', pictures, re.MULTILINE):
        file = repository / f"docs/images/{name}.png"
        assert 10_000 < file.stat().st_size < 400_000
