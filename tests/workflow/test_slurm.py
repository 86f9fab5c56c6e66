"""The tiny configuration on a real cluster of one node, where SLURM kills a job on the way."""

import os
import signal
import subprocess
import time

import pytest
from slurm_node import slurm_node, what_is_missing
from workflow_runs import start, succeed

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(bool(what_is_missing()), reason=what_is_missing() or "SLURM is there"),
]

#: This cluster keeps no accounts, and its files appear at once.
OPTIONS = "--slurm-status-command squeue --slurm-no-account --latency-wait 5"
OPTIONS += " --slurm-init-seconds-before-status-checks 5"
#: Groups of short steps, a task of an array for each solid, and a model of several materials.
MODELS = ["torus", "hollow_sphere", "chesapeake", "polycrystal"]
TARGETS = [f"results/{model}/verdict.csv" for model in MODELS]
TARGETS += [f"results/{model}/verification.csv" for model in MODELS[:2]]


@pytest.fixture
def make_folder(repository, tmp_path):
    """Return a function that makes a folder with the configuration and the geometry."""

    def make_folder(name):
        folder = tmp_path / name
        folder.mkdir()
        for part in ("config", "data_sources"):
            (folder / part).symlink_to(repository / part)
        return folder

    return make_folder


def kill_first_job(environment):
    """Kill the first job that runs, as SLURM does with a job that exceeds its memory or time."""
    show = ["squeue", "--noheader", "--states=RUNNING", "--format=%i"]
    end = time.monotonic() + 300
    while time.monotonic() < end:
        done = subprocess.run(show, env=environment, capture_output=True, text=True, check=True)
        if done.stdout.split():
            job = done.stdout.split()[0]
            time.sleep(5)
            kill = ["scancel", "--full", f"--signal={signal.SIGKILL.name[3:]}", job]
            subprocess.run(kill, env=environment, check=True)
            return job
        time.sleep(0.5)
    raise AssertionError("no job runs")


def test_jobs_of_slurm_give_the_same_files_though_one_is_killed(repository, make_folder, tmp_path):
    tiny = ["--configfile", "config/tiny.yaml", "--", *TARGETS]
    here, there = make_folder("here"), make_folder("there")
    succeed(here, *tiny)

    profile = ["--profile", os.fspath(repository / "profiles/slurm")]
    with slurm_node(tmp_path / "slurm") as environment:
        run = start(there, *profile, *OPTIONS.split(), *tiny, cores=None, **environment)
        kill_first_job(environment)
        messages, _ = run.communicate(timeout=3600)
    assert run.returncode == 0, messages
    assert "Trying to restart job" in messages

    files = [p.relative_to(here) for m in MODELS for p in here.glob(f"results/{m}/**/*")]
    files = {p for p in files if (here / p).is_file() and p.suffix != ".log"}
    assert len(files) > 10 * len(MODELS)
    for path in files:
        assert (here / path).read_bytes() == (there / path).read_bytes(), path
    left = {p.relative_to(there) for m in MODELS for p in there.glob(f"results/{m}/**/*")}
    assert files == {p for p in left if (there / p).is_file() and p.suffix != ".log"}
