"""The map of files agrees with the files written, and the pages that show it are current."""

import re
import sys

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
