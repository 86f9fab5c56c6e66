import os
import sys
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from filelock import FileLock

from tusqh.compiled import compile_functions, is_compiled, write_bytecode
from tusqh.geometry.outline import Outline

# Threads that wait leave the processor to other processes of the tests.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")

REPOSITORY = Path(__file__).resolve().parent.parent

sys.path.insert(0, str(Path(__file__).parent))  # For modules such as `oracles` and `fields`.

from needs import require_rendering  # noqa: E402
from small_project import add_models  # noqa: E402
from workflow_runs import succeed  # noqa: E402


def pytest_xdist_auto_num_workers(config):
    """Run the whole suite on all processors, and named files in this process."""
    is_whole = config.args_source is config.ArgsSource.TESTPATHS
    return min(os.cpu_count() or 1, 8) if is_whole else 0


#: Files that take longest: they run first, so that no process waits for another at the end.
LONGEST = [
    "tests/workflow/test_tiny_dag.py",
    "tests/test_structure.py",
    "tests/provenance/",
    "tests/workflow/",
    "tests/test_examples.py",
    "tests/cli/",
    "tests/explorer/",
]


def pytest_collection_modifyitems(items):
    """Put the tests that take longest first; xdist then gives files to processes in this order."""

    def rank(item):
        return next((k for k, path in enumerate(LONGEST) if item.nodeid.startswith(path)), 99)

    items.sort(key=rank)


def pytest_configure(config):
    """Compile before several workers start, which would all compile the same functions."""
    is_controller = not hasattr(config, "workerinput")
    if is_controller:
        write_bytecode(*[REPOSITORY / package for package in ("tusqh", "provenance", "studies")])
    if is_controller and getattr(config.option, "numprocesses", None) and not is_compiled():
        compile_functions()


@pytest.fixture(scope="session")
def repository() -> Path:
    return REPOSITORY


@pytest.fixture
def square() -> Outline:
    """Return the unit square, counter-clockwise."""
    return Outline.from_chains(
        [np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])], name="square"
    )


@pytest.fixture(scope="session")
def make_once(tmp_path_factory):
    """Return a function that fills a folder once, even when several processes run the tests."""
    base = tmp_path_factory.getbasetemp()
    shared = base.parent if os.environ.get("PYTEST_XDIST_WORKER") else base

    def make_once(name, fill):
        folder, ended = shared / name, shared / f"{name}.ended"
        with FileLock(shared / f"{name}.lock"):
            if not ended.exists():
                ended.write_text("failed in another process, whose messages say why")
                folder.mkdir()
                fill(folder)
                ended.write_text("")
        if ended.read_text():
            pytest.fail(f"{name}: {ended.read_text()}")
        return folder

    return make_once


@pytest.fixture(scope="session")
def built(make_once):
    """Return a small project with all its results. No test may change it."""

    require_rendering()

    def build(folder):
        add_models(folder)
        succeed(folder, TZ="UTC", PYTHONHASHSEED="0")

    return make_once("built", build)


def pytest_terminal_summary(terminalreporter):
    """Say which tests were not run, why, and how to get what they need."""
    reports = terminalreporter.stats.get("skipped", [])
    reasons = Counter(str(report.longrepr[-1]).removeprefix("Skipped: ") for report in reports)
    if reasons:
        terminalreporter.section("Not run")
    for reason, n_tests in sorted(reasons.items()):
        terminalreporter.line(f"{n_tests} {'test' if n_tests == 1 else 'tests'}: {reason}")
