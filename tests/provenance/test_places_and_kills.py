"""Results are the same in another place and environment, and after processes are killed."""

import random
import shutil
import time

import psutil
import pytest
from project import Project
from small_project import add_models, copy_code
from workflow_runs import start, succeed

from provenance import code
from provenance.findings import Outcome, merge

#: Environment variables that must not affect the results.
SURROUNDINGS = {
    "TZ": "Asia/Kathmandu",
    "LC_ALL": "C",
    "LANG": "de_DE.UTF-8",
    "PYTHONHASHSEED": "7",
    "OMP_NUM_THREADS": "3",
    "COLUMNS": "40",
}


def kill(process):
    """Kill a process and all that it has started, without a chance to clean up."""
    family = [process, *psutil.Process(process.pid).children(recursive=True)]
    for member in family:
        member.kill()
    process.wait()


def run_with_kills(folder, n_kills, seed):
    """Run the workflow, kill it at random moments while it works, and let it end at last.

    Return the number of kills until all steps were done.
    """
    rng = random.Random(seed)
    surroundings = SURROUNDINGS | {"PYTHONPATH": str(folder)}
    # A killed process leaves the folder locked; the profile makes unfinished outputs again.
    arguments = ["--nolock"]
    options = {"snakefile": folder / "Snakefile", "cores": 3} | surroundings
    kills = 0
    while kills < n_kills:
        process = start(folder, *arguments, **options)
        wanted, finished = rng.randint(0, 3), 0
        for line in process.stdout:
            finished += line.startswith("Finished jobid")
            if "Execute" in line and finished >= wanted:
                time.sleep(rng.uniform(0, 2))
                break
        if process.poll() is not None:
            break
        kill(process)
        kills += 1
    succeed(folder, *arguments, **options)
    return kills


def check_the_same(locked, folder, monkeypatch):
    """Compare every record and file with those made undisturbed in another place."""
    names = {p.relative_to(locked) for p in (locked / "results").rglob("*") if p.is_file()}
    there = {p.relative_to(folder) for p in (folder / "results").rglob("*") if p.is_file()}
    (folder / "results/lock.json").write_bytes((locked / "results/lock.json").read_bytes())
    assert there | {(folder / "results/lock.json").relative_to(folder)} == names
    whats = [n for n in names if "provenance" in n.parts and not n.name.endswith(".how.json")]
    assert len(whats) > 40
    for name in whats:
        assert (folder / name).read_bytes() == (locked / name).read_bytes(), name
    monkeypatch.chdir(folder)
    monkeypatch.setattr(code, "PACKAGE_ROOT", folder)
    report = Project(folder, folder / "Snakefile").verify()
    assert report.verdict is Outcome.SAME, merge(report.findings)
    assert set(report.classes.values()) == {"exact"}


@pytest.mark.slow
def test_elsewhere_and_after_kills_every_byte_is_the_same(
    repository, locked, tmp_path, monkeypatch
):
    folder = tmp_path / "otherwise"
    folder.mkdir()
    add_models(folder)
    copy_code(repository, folder)
    assert run_with_kills(folder, 20, seed=20) == 20
    check_the_same(locked, folder, monkeypatch)


@pytest.mark.slow
def test_one_model_made_again_elsewhere_with_kills_is_the_same(locked, checkout, monkeypatch):
    shutil.rmtree(checkout / "results/plate")
    assert run_with_kills(checkout.folder, 3, seed=3) == 3
    check_the_same(locked, checkout.folder, monkeypatch)


def jobs_of(said):
    """Return the rule and the model of every job in a dry run."""
    jobs, rule = set(), None
    for line in said.splitlines():
        words = line.split()
        if line.startswith(("rule ", "localrule ")):
            rule = words[1].rstrip(":")
            jobs.add((rule, None))
        elif rule and words[:1] == ["wildcards:"]:
            jobs.discard((rule, None))
            jobs.add((rule, words[1].removeprefix("model=").rstrip(",")))
    return jobs


def in_its_folder(project, *arguments):
    """Run snakemake with the copy of the code beside the results."""
    options = {"snakefile": project.snakefile, "PYTHONPATH": str(project.folder)}
    return succeed(project.folder, *arguments, **options)


def dry_run(project):
    return in_its_folder(project, "--dry-run")


def test_one_models_entry_reruns_that_models_steps(checkout):
    checkout.edit("config/config.yaml", "threshold: 0.5", "threshold: 0.6")
    jobs = jobs_of(dry_run(checkout))
    # The grid of the plate is placed for its threshold.
    assert {("sample", "plate"), ("select", "plate")} <= jobs
    assert {model for _, model in jobs} == {"plate", None}
    assert ("ingest", "plate") not in jobs


def test_a_figures_script_reruns_that_figure_and_what_shows_it(checkout):
    script = "workflow/scripts/figures_of_outline.py"
    checkout.edit(script, "import pandas as pd", "import pandas as pd\n\n_SCALE = 1")
    jobs = jobs_of(dry_run(checkout))
    assert {job for job in jobs if job[1]} == {("figures_of_outline", "plate")}
    assert {rule for rule, model in jobs if not model} <= {"overview", "crate", "all"}


def test_comments_and_touched_files_rerun_nothing(checkout):
    checkout.edit(
        "workflow/scripts/mesh.py",
        "from pathlib import Path",
        "from pathlib import Path  # for the record",
    )
    checkout.edit("tusqh/grid/background.py", '"""', '"""Really: ')
    for folder in ("tusqh", "workflow", "config"):
        for path in (checkout / folder).rglob("*"):
            path.touch()
    assert "Nothing to be done" in dry_run(checkout)


def test_the_remedy_restores_the_file(checkout):
    file = "results/plate/fractions.npz"
    checkout.flip(file)
    (finding,) = [f for f in checkout.verify().findings if f.file == file]
    words = finding.remedy.replace(f"--snakefile {checkout.snakefile}", "").split()
    in_its_folder(checkout, *words[1:])
    assert checkout.verify().verdict is Outcome.SAME
