"""The output and the exit codes of the commands, run as a user runs them."""

import json
import re
import shutil
import subprocess
import sys

import pytest
from typer.testing import CliRunner

from provenance.rebuild import rebuild_model
from provenance.stored import read_records
from tusqh.cli.app import app
from tusqh.errors import ConfigError, ProvenanceError, TusqhError

FIGURE = "results/plate/figures/diagram.png"


@pytest.fixture
def run(project):
    """Run a command, and return exit code and what it prints without line breaks."""

    def run(*arguments, options=True):
        options = ["--snakefile", str(project.snakefile)] if options else []
        done = CliRunner(env={"COLUMNS": "400"}).invoke(app, [*arguments, *options])
        if isinstance(done.exception, TusqhError):
            raise done.exception
        return done.exit_code, done.output

    return run


def test_verify_says_same_different_and_cannot_tell(project, run):
    code, text = run("verify")
    assert code == 0
    assert "same: all" in text
    assert "recording took" in text
    project.flip(FIGURE)
    code, text = run("verify")
    assert code == 1
    assert f"different: {FIGURE} (plate/figures_of_topology)" in text
    assert f"--force -- {FIGURE}" in text
    shutil.rmtree(project / "results/provenance")
    code, text = run("verify")
    assert code == 2
    assert "cannot tell" in text


def test_verify_prints_json(project, run):
    project.flip(FIGURE)
    code, text = run("verify", "--json")
    report = json.loads(text[text.index("{") :])
    assert (code, report["exit_code"], report["verdict"]) == (1, 1, "different")
    (finding,) = [f for f in report["findings"] if f["outcome"] == "different"]
    assert finding["file"] == FIGURE
    outcomes = {row["step"]: row for row in report["steps"]}
    assert outcomes["plate/mesh"] == {"step": "plate/mesh", "outcome": "same", "equality": "exact"}
    assert 0 < report["recording_share"] < 0.5


def test_lock_refuses_what_is_not_as_recorded_and_says_what_changed(project, run):
    before = (project / "results/lock.json").read_bytes()
    project.flip(FIGURE)
    with pytest.raises(ProvenanceError, match=r"diagram\.png"):
        run("lock")
    assert (project / "results/lock.json").read_bytes() == before
    project.flip(FIGURE)
    code, text = run("lock")
    assert code == 0
    assert "changed" not in text
    assert (project / "results/lock.json").read_bytes() == before, "the same results, the same lock"
    (project / "results/lock.json").unlink()
    assert f"added  {FIGURE}" in run("lock")[1]


def test_trace_leads_to_the_register(run):
    code, text = run("trace", FIGURE, options=False)
    assert code == 0
    steps = ("plate/figures_of_topology", "plate/sample")
    for part in (*steps, "data_sources/plate.svg", "BSD-3-Clause"):
        assert part in text


@pytest.mark.parametrize("figure", [FIGURE, "results/figures/pinches_in_series.png"])
def test_trace_knows_a_figure_found_elsewhere(project, run, tmp_path, figure):
    slide = tmp_path / "slide.png"
    content = (project / figure).read_bytes()
    slide.write_bytes(content)
    assert "the same bytes" in run("trace", str(slide), options=False)[1]
    # Another program saves the file again and keeps texts.
    slide.write_bytes(content[:-12] + b"\0\0\0\1tEXtx\0\0\0\0" + content[-12:])
    code, text = run("trace", str(slide), options=False)
    assert code == 0
    assert f"{slide} is {figure}: other bytes, but the mark of that figure" in text


def test_trace_says_when_something_behind_has_changed(project, run):
    project.flip("results/plate/fractions.npz")
    code, text = run("trace", FIGURE, options=False)
    assert code == 1
    assert "changed: results/plate/fractions.npz" in text


def test_trace_says_when_a_step_read_something_else(project, run):
    zeros = {"sha256": 64 * "0"}
    project.edit_record(
        "results/provenance/plate/export.json", lambda what: what["inputs"][0].update(zeros)
    )
    code, text = run("trace", "results/plate/export/mesh.msh", options=False)
    assert code == 1
    assert "changed: results/plate/" in text


def test_trace_says_when_a_record_is_missing(project, run):
    (project / "results/provenance/plate/mesh.json").unlink()
    code, text = run("trace", "results/plate/export/mesh.msh", options=False)
    assert code == 1
    assert "its record is missing" in text
    code, text = run("verify")
    assert code == 2
    assert "--forcerun results/provenance/plate/mesh.json" in text


def test_a_broken_lock_can_be_made_again_and_a_missing_one_is_an_error(project, run):
    before = (project / "results/lock.json").read_bytes()
    (project / "results/lock.json").write_text("<<<<<<< HEAD")
    with pytest.raises(ConfigError, match="cannot be read as a lock"):
        run("verify")
    code, text = run("lock")
    assert code == 0
    assert "warning: " in text
    assert (project / "results/lock.json").read_bytes() == before
    with pytest.raises(ConfigError, match="the lock does not exist"):
        run("verify", "--lock", "other.json")


def test_remedies_are_one_line(project):
    project.flip(FIGURE)
    command = ["verify", "--snakefile", str(project.snakefile)]
    done = CliRunner(env={"COLUMNS": "40"}).invoke(app, command)
    (remedy,) = [line for line in done.output.splitlines() if "remedy:" in line]
    assert remedy.endswith(f" --force -- {FIGURE}")


def test_trace_of_a_stranger(run, tmp_path):
    (tmp_path / "stranger.png").write_bytes(b"\x89PNG\r\n\x1a\n")
    with pytest.raises(ProvenanceError, match="no record contains"):
        run("trace", str(tmp_path / "stranger.png"), options=False)


def test_rebuild_compares_the_results_of_another_run(project):
    def copy_but_one(plan, folder, targets):
        for target in targets:
            (folder / target).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(target, folder / target)
        (folder / "results/plate/curves.csv").write_text("upper,lower\n")

    plan, records = project.plan(), read_records()
    *different, note = rebuild_model("plate", plan, records, run=copy_but_one)
    assert [finding.file for finding in different] == ["results/plate/curves.csv"]
    assert "1 different" in note.found
    with pytest.raises(ProvenanceError, match="there is no model 'plates'"):
        rebuild_model("plates", plan, records, run=copy_but_one)


@pytest.mark.slow
def test_rebuild_for_real(project):
    # Use a separate process, because Snakemake's messages need a real standard error.
    command = [sys.executable, "-m", "tusqh", "verify", "--rebuild", "plate"]
    options = ["--snakefile", str(project.snakefile)]
    done = subprocess.run([*command, *options], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.search(r"(\d+) outputs made again: \1 exact", done.stdout)
