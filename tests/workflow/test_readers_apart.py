"""A change in one reader reruns the models in its format and no others."""

import re

import pytest
from small_project import copy_code, copy_results
from workflow_runs import succeed

from provenance.code import code_files

TARGETS = ["results/plate/fractions.npz", "results/ring/fractions.npz"]


@pytest.fixture
def checkout(repository, built, tmp_path):
    """Return a copy of the results, beside an editable copy of the code that made them."""
    folder = tmp_path / "checkout"
    copy_results(built, folder)
    copy_code(repository, folder)
    return folder


def planned(checkout):
    """Return the rules that a dry run would run, each with its model."""
    options = {"snakefile": checkout / "Snakefile", "PYTHONPATH": str(checkout)}
    text = succeed(checkout, "--dry-run", "--", *TARGETS, **options)
    return set(re.findall(r"rule (\w+):.*?wildcards: model=(\w+)", text, re.DOTALL))


def edit(path, old, new):
    text = path.read_text()
    assert text.count(old) == 1
    path.write_text(text.replace(old, new))


def test_a_change_in_one_reader_reruns_the_models_in_its_format(checkout):
    assert planned(checkout) == set()
    edit(
        checkout / "tusqh/readers/svg.py",
        "elements without a fill read as lines",
        "elements without fill read as lines",
    )
    assert planned(checkout) == {("ingest", "plate"), ("sample", "plate")}
    edit(checkout / "tusqh/readers/stl.py", "a complete STL file", "an undamaged STL file")
    assert ("ingest", "ring") in planned(checkout)


def test_no_step_after_ingest_runs_a_reader(repository):
    scripts = sorted((repository / "workflow/scripts").glob("*.py"))
    assert len(scripts) > 20
    for script in scripts:
        name = f"workflow/scripts/{script.name}"
        readers = {f for f in code_files(name, base=repository) if "tusqh/readers/" in f}
        formats = {f for f in readers if f.removeprefix("tusqh/readers/") in ("svg.py", "stl.py")}
        assert not formats, script.name
        if script.stem in ("sample", "select", "mesh", "figures_of_outline", "sweep"):
            assert not readers, script.name
