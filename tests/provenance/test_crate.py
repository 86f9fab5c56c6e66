"""Programs by other authors accept the crate as valid."""

import io
import json
import shutil

import pytest
from ro_crates import find_issues
from runcrate.report import dump_crate_actions

from provenance.stored import read_records

PROFILE = "provenance-run-crate"


def test_the_validator_finds_no_issue(project, monkeypatch, tmp_path):
    assert find_issues(project / "results", PROFILE, monkeypatch, tmp_path) == []


@pytest.mark.parametrize(
    ("kind", "key"),
    [("HowToStep", "workExample"), ("OrganizeAction", "instrument"), ("Dataset", "mainEntity")],
)
def test_the_validator_notices_a_missing_property(project, monkeypatch, tmp_path, kind, key):
    small = tmp_path / "crate"
    small.mkdir()
    crate = json.loads((project / "results/ro-crate-metadata.json").read_text())
    for entity in crate["@graph"]:
        if entity["@type"] == kind:
            entity.pop(key)
    (small / "ro-crate-metadata.json").write_text(json.dumps(crate))
    shutil.copytree(project / "results/workflow", small / "workflow")
    issues = find_issues(small, PROFILE, monkeypatch, tmp_path)
    assert any(kind in issue or key in issue for issue in issues), issues


def test_runcrate_reads_every_step_with_its_files(project):
    text = io.StringIO()
    dump_crate_actions(str(project / "results"), f=text)
    runs = {}
    for block in text.getvalue().split("\n\n"):
        lines = block.splitlines()
        if lines:
            runs[lines[0].removeprefix("action: ")] = {line.strip() for line in lines[1:]}
    records = read_records()
    del records["crate"]  # This file describes the others.
    assert runs.keys() == {"#run", *(f"#run/{key}" for key in records)}
    for key, record in records.items():
        said = runs[f"#run/{key}"]
        step = f"step: workflow/Snakefile#{record.what['step']}"
        assert step in said
        for path in [*record.outputs, *record.inputs]:
            if path.startswith("results/"):
                assert path.removeprefix("results/") in said


def test_sources_have_their_licence_and_stay_outside(project):
    crate = json.loads((project / "results/ro-crate-metadata.json").read_text())
    entities = {entity["@id"]: entity for entity in crate["@graph"]}
    assert len(entities) == len(crate["@graph"]), "ids are unique"
    sources = [e for e in entities.values() if e["@id"].startswith("ni:///sha-256;")]
    licences = {e["name"]: e.get("license") for e in sources}
    assert licences["data_sources/plate.svg"] == "BSD-3-Clause"
    assert licences["data_sources/ring.stl"] == "CC0-1.0"
    for entity in entities.values():
        for value in entity.values():
            for one in value if isinstance(value, list) else [value]:
                if isinstance(one, dict) and not one["@id"].startswith("http"):
                    assert one["@id"] in entities, f"{entity['@id']} refers to {one['@id']}"
