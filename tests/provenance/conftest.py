"""A whole project that is built once; every test may change a copy of it."""

import pytest
from project import Project
from small_project import copy_code, copy_results

from provenance import code
from provenance.lock import LOCK, make_lock, write_lock
from provenance.plan import make_plan
from provenance.stored import read_records


@pytest.fixture(scope="session")
def locked(repository, built, make_once):
    """Return all results and their lock. No test may change them."""

    def lock(folder):
        copy_results(built, folder)
        with pytest.MonkeyPatch.context() as patch:
            patch.chdir(folder)
            write_lock(make_lock(make_plan(repository / "Snakefile"), read_records()), LOCK)

    return make_once("locked", lock)


@pytest.fixture
def project(repository, locked, tmp_path, monkeypatch):
    """Return a copy of the results, with the code of this repository."""
    folder = tmp_path / "elsewhere"
    copy_results(locked, folder)
    monkeypatch.chdir(folder)
    return Project(folder, repository / "Snakefile")


@pytest.fixture
def checkout(repository, project, monkeypatch):
    """Return a copy of the results, beside a copy of the code that made them."""
    copy_code(repository, project.folder)
    monkeypatch.setattr(code, "PACKAGE_ROOT", project.folder)
    return Project(project.folder, project / "Snakefile")
