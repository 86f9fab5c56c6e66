"""The same results in another place and surroundings, and after any number of sudden deaths."""

import random
import time

import psutil
import pytest
from small_project import Project, add_models, copy_checkout, snakemake, start

from provenance import code
from provenance.findings import Outcome, merge

#: Nothing of this may leave a trace in the results.
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

    Returns how many kills there were before nothing was left to do.
    """
    rng = random.Random(seed)
    # The folder is locked by whoever died; its profile makes unfinished outputs again.
    command = ["--cores", "3", "--nolock"]
    surroundings = SURROUNDINGS | {"PYTHONPATH": str(folder)}
    kills = 0
    while kills < n_kills:
        process = start(folder, *command, **surroundings)
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
    snakemake(folder, *command, **surroundings)
    return kills


def check_the_same(built, folder, monkeypatch):
    """Compare every record and file with those made undisturbed in another place."""
    names = {p.relative_to(built) for p in (built / "results").rglob("*") if p.is_file()}
    there = {p.relative_to(folder) for p in (folder / "results").rglob("*") if p.is_file()}
    (folder / "results/lock.json").write_bytes((built / "results/lock.json").read_bytes())
    assert there | {(folder / "results/lock.json").relative_to(folder)} == names
    whats = [n for n in names if "provenance" in n.parts and not n.name.endswith(".how.json")]
    assert len(whats) > 40
    for name in whats:
        assert (folder / name).read_bytes() == (built / name).read_bytes(), name
    monkeypatch.chdir(folder)
    monkeypatch.setattr(code, "PACKAGE_ROOT", folder)
    report = Project(folder, folder / "Snakefile").verify()
    assert report.verdict is Outcome.SAME, merge(report.findings)
    assert set(report.classes.values()) == {"exact"}


@pytest.mark.parametrize(
    "n_kills", [3, pytest.param(20, marks=pytest.mark.slow)], ids="{}-kills".format
)
def test_elsewhere_and_after_kills_every_byte_is_the_same(
    repository, built, tmp_path, monkeypatch, n_kills
):
    folder = tmp_path / "otherwise"
    folder.mkdir()
    add_models(repository, folder)
    copy_checkout(repository, folder)
    assert run_with_kills(folder, n_kills, seed=n_kills) == n_kills
    check_the_same(built, folder, monkeypatch)


def jobs_of(said):
    """Return rule and model of every job in a dry run."""
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


def dry_run(project):
    return snakemake(project.folder, "--dry-run", PYTHONPATH=str(project.folder))


def test_one_models_entry_reruns_that_models_steps(checkout):
    checkout.edit("config/config.yaml", "threshold: 0.5", "threshold: 0.6")
    jobs = jobs_of(dry_run(checkout))
    assert ("select", "gap") in jobs
    assert {model for _, model in jobs} == {"gap", None}
    assert not {("ingest", "gap"), ("sample", "gap"), ("sweep_2d", "gap")} & jobs


def test_a_figures_script_reruns_that_figure_and_what_shows_it(checkout):
    script = "workflow/scripts/figure_contaminant.py"
    checkout.edit(script, "import pandas as pd", "import pandas as pd\n\n_SCALE = 1")
    jobs = jobs_of(dry_run(checkout))
    assert {job for job in jobs if job[1]} == {("figure_contaminant", "gap")}
    assert {rule for rule, model in jobs if not model} <= {"overview", "crate", "all"}


def test_comments_and_touched_files_rerun_nothing(checkout):
    checkout.edit("workflow/scripts/mesh.py", "import json", "import json  # for the record")
    checkout.edit("tusqh/grid.py", '"""', '"""Really: ')
    for folder in ("tusqh", "workflow", "config"):
        for path in (checkout / folder).rglob("*"):
            path.touch()
    assert "Nothing to be done" in dry_run(checkout)


def test_the_remedy_mends(checkout):
    file = "results/gap/fractions.npz"
    checkout.flip(file)
    (finding,) = [f for f in checkout.verify().findings if f.file == file]
    words = finding.remedy.replace(f"--snakefile {checkout.snakefile}", "").split()
    snakemake(checkout.folder, *words[1:], PYTHONPATH=str(checkout.folder))
    assert checkout.verify().verdict is Outcome.SAME
