"""A whole project, built once, that every test may spoil a copy of."""

import shutil
from pathlib import Path

import pytest
from small_project import Project, add_models, copy_checkout, snakemake

from provenance import code
from provenance.lock import LOCK, make_lock, write_lock
from provenance.plan import make_plan
from provenance.stored import read_records


@pytest.fixture(scope="session")
def built(repository, tmp_path_factory):
    """A folder with all results and their lock; not to be changed."""
    folder = tmp_path_factory.mktemp("built")
    add_models(repository, folder)
    snakefile = str(repository / "Snakefile")
    snakemake(folder, "--snakefile", snakefile, "--cores", "2", TZ="UTC", PYTHONHASHSEED="0")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        write_lock(make_lock(make_plan(repository / "Snakefile"), read_records()), LOCK)
    return folder


def _leave_out(folder, names):
    """Name what Snakemake keeps for itself, which copies do not need."""
    return {"log", "locks", "scripts"} & set(names) if Path(folder).name == ".snakemake" else set()


@pytest.fixture
def project(repository, built, tmp_path, monkeypatch):
    """A copy of the results, with the code of this repository."""
    folder = tmp_path / "elsewhere"
    shutil.copytree(built, folder, ignore=_leave_out)
    monkeypatch.chdir(folder)
    return Project(folder, repository / "Snakefile")


@pytest.fixture
def checkout(repository, project, monkeypatch):
    """A copy of the results, beside a copy of the code that made them."""
    copy_checkout(repository, project.folder)
    monkeypatch.setattr(code, "PACKAGE_ROOT", project.folder)
    return Project(project.folder, project / "Snakefile")
