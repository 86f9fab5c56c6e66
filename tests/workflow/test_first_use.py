"""The habits of Snakemake's users: modules, other folders, targets, priorities, typing errors."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

GAP = """models:
  gap:
    geometry: gap.svg
    unit: mm
    grid: {cells: 12}
    threshold: 0.5
"""
MODULE = """configfile: "settings.yaml"

module tusqh:
    snakefile: "{repository}/Snakefile"
    config: config

use rule * from tusqh

rule mine:
    input: "results/gap/selection.json"
    output: "mine.txt"
    shell: "cp {{input}} {{output}}"
"""


def snakemake(folder, *arguments):
    """Run snakemake in a folder, without help from the environment to find the packages."""
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    command = [sys.executable, "-m", "snakemake", "--cores", "2", *arguments]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


@pytest.fixture
def elsewhere(repository, tmp_path):
    """Return a folder with a geometry and a configuration, outside the checkout."""
    (tmp_path / "gap.svg").write_text((repository / "data_sources/analytic/gap.svg").read_text())
    (tmp_path / "settings.yaml").write_text(GAP)
    return tmp_path


def test_another_workflow_uses_this_one_as_a_module(repository, elsewhere):
    (elsewhere / "Snakefile").write_text(MODULE.format(repository=repository))
    code, said = snakemake(elsewhere, "mine.txt")
    assert code == 0, said
    assert '"threshold"' in (elsewhere / "mine.txt").read_text()
    assert (elsewhere / "results/provenance/gap/select.json").is_file()
    assert (elsewhere / "results/gap/logs/select.log").is_file()


def test_it_runs_from_another_folder_and_takes_targets_after_the_configuration(
    repository, elsewhere
):
    snakefile = str(repository / "Snakefile")
    options = ("-s", snakefile, "--configfile", "settings.yaml")
    code, said = snakemake(elsewhere, *options, "--", "results/gap/geometry.vtp")
    assert code == 0, said
    assert (elsewhere / "results/gap/geometry.vtp").is_file()


def test_the_readme_says_how_to_give_a_target_after_the_configuration(repository):
    assert "--configfile config/tiny.yaml -- results/" in (repository / "README.md").read_text()


def test_a_misspelt_model_gets_a_hint(repository, elsewhere):
    options = ("-s", str(repository / "Snakefile"), "--configfile", "settings.yaml", "-n")
    code, said = snakemake(elsewhere, *options, "--", "results/gapp/mesh.vtu")
    assert code != 0
    assert "there is no model 'gapp'; did you mean 'gap'?" in said


def test_models_can_be_made_without_the_studies_and_come_first(repository, elsewhere):
    options = ("-s", str(repository / "Snakefile"), "--configfile", "settings.yaml", "-n")
    code, said = snakemake(elsewhere, *options, "--", "models")
    assert code == 0, said
    steps = set(re.findall(r"^(?:local)?rule (\w+):", said, re.MULTILINE))
    assert {"mesh", "quality", "explorer", "export"} <= steps
    assert not {"theorem_plane", "placements", "overview", "figures_of_topology", "claims"} & steps
    jobs = dict(re.findall(r"^rule (\w+):\n((?: .*\n)+)", said, re.MULTILINE))
    assert "priority: 1" in jobs["mesh"]
    code, said = snakemake(elsewhere, *options)
    jobs = dict(re.findall(r"^rule (\w+):\n((?: .*\n)+)", said, re.MULTILINE))
    assert "priority: 1" in jobs["ingest"]
    assert "priority" not in jobs["pinch_catalogue"]


@pytest.mark.slow
def test_thresholds_and_placements_can_be_jobs_of_their_own(repository, elsewhere):
    (elsewhere / "settings.yaml").write_text(GAP + "study: {placements: 4, cells_2d: [8]}\n")
    options = ("-s", str(repository / "Snakefile"), "--configfile", "settings.yaml")
    wanted = [f"results/gap/{name}.csv" for name in ("verification", "placements", "stability")]
    tables = []
    for split, n_sweeps, n_parts in ((1, 0, 0), (3, 7, 3)):
        code, said = snakemake(
            elsewhere, *options, "--config", f"split={split}", "-F", "--", *wanted
        )
        assert code == 0, said
        rules = re.findall(r"^(?:local)?rule (\w+):", said, re.MULTILINE)
        assert rules.count("sweep_one") == n_sweeps
        assert rules.count("placements_part") == n_parts
        tables.append([(elsewhere / path).read_bytes() for path in wanted])
    assert tables[0] == tables[1]


def test_every_step_has_a_record_a_log_and_the_fingerprint_of_its_code(repository, monkeypatch):
    monkeypatch.chdir(repository)
    monkeypatch.syspath_prepend(str(repository / "docs"))
    monkeypatch.delitem(sys.modules, "files", raising=False)
    import files

    steps = [rule for rule in files.load_rules() if rule.script]
    assert len(steps) > 40
    for rule in steps:
        assert str(rule.output.record).startswith("results/provenance/"), rule.name
        assert str(rule.output.record_how).endswith(".how.json"), rule.name
        own = f"workflow/scripts/{Path(rule.script).name}"
        assert rule.params.code["script"] == own, rule.name
        assert rule.log, rule.name


def test_snakemake_finds_no_fault_with_the_rules(repository):
    code, said = snakemake(repository, "--lint")
    assert code == 0, said
    assert "in a good condition" in said
