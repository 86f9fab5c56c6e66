"""The map of files agrees with the files written, and the pages that show it are current."""

import re
import sys

import numpy as np
import pandas as pd
import pytest

import tusqh
from tusqh.files import RESULT_FILES, path_of


@pytest.mark.parametrize(
    ("source", "dimension"),
    [("data_sources/analytic/gap.svg", 2), ("data_sources/solids/torus.stl", 3)],
)
def test_saved_tables_have_the_listed_columns(repository, tmp_path, source, dimension):
    tusqh.mesh(repository / source, cells=10, threshold=0.5).save(tmp_path)
    names = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*.*")}
    assert names <= {file.path for file in RESULT_FILES.values()}
    tables = [name for name in RESULT_FILES if path_of(name, tmp_path).suffix == ".csv"]
    saved = [name for name in tables if path_of(name, tmp_path).exists()]
    assert len(saved) >= 10
    for name in saved:
        columns = tuple(pd.read_csv(path_of(name, tmp_path), nrows=1).columns)
        assert columns == RESULT_FILES[name].columns_of(dimension), name


def test_tables_of_several_materials_have_the_listed_columns(tmp_path):
    labels = np.array([[1, 1, 0, 1, 2], [1, 1, 0, 1, 2]])
    wish = {"material": "1", "row": 1, "do": "cut"}
    found = tusqh.mesh(labels, materials="labels", features=[wish])
    found.save(tmp_path)
    tables = [file for file in RESULT_FILES.values() if file.columns_of_materials]
    assert len(tables) == 2
    for file in tables:
        columns = pd.read_csv(tmp_path / file.path).columns
        assert tuple(columns) == tuple(c for c in file.columns_of_materials if c != "z")
    assert len(pd.read_csv(tmp_path / "changes.csv")) == 1


def test_names_and_paths_are_unique():
    paths = [file.path for file in RESULT_FILES.values()]
    assert len(set(paths)) == len(paths)
    assert all(name == file.name for name, file in RESULT_FILES.items())


def test_the_readme_describes_files_as_the_map_does(repository):
    text = (repository / "README.md").read_text()
    rows = re.findall(r"^\| `results/<model>/([\w/.]+\.\w+)` \| (.*?) \|$", text, re.MULTILINE)
    sentences = {file.path: file.sentence for file in RESULT_FILES.values()}
    assert len(rows) >= 8
    for path, sentence in rows:
        assert sentence.startswith(sentences[path]), path


def test_the_page_of_files_is_current(repository, monkeypatch):
    monkeypatch.chdir(repository)
    monkeypatch.syspath_prepend(str(repository / "docs"))
    monkeypatch.delitem(sys.modules, "files", raising=False)
    import files

    assert files.render_page(files.load_rules()) == files.PAGE.read_text(encoding="utf-8")
