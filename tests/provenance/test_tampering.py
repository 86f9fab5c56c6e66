"""`tusqh verify` notices every change that matters, and does not report those that do not."""

import json
import os
import shutil

import pytest
from workflow_runs import succeed

from provenance import check, compare
from provenance.digests import Digests
from provenance.environment import installed_versions
from provenance.findings import Outcome, merge
from provenance.register import read_register
from provenance.stored import read_records
from provenance.verify import require_lockable
from tusqh.errors import ConfigError, ProvenanceError

DIFFERENT, CANNOT_TELL, SAME = Outcome.DIFFERENT, Outcome.CANNOT_TELL, Outcome.SAME
RECORDS = "results/provenance"


def find(report, file):
    """Return the findings about a file, each of which must be of use to a reader."""
    found = [f for f in merge(report.findings) if file in f.file and f.outcome is not SAME]
    assert found, [f.file for f in report.findings]
    for finding in found:
        assert finding.found
        assert finding.expected
        assert finding.found != finding.expected
        assert finding.remedy
    return found


def state_of(project, path):
    return {"sha256": Digests().of(path), "size": (project / path).stat().st_size}


def test_untouched_results_are_the_same_in_another_place(checkout):
    report = checkout.verify()
    assert report.verdict is SAME, merge(report.findings)
    assert set(report.classes.values()) == {"exact"}
    assert report.recording_share > 0


def test_a_flipped_bit_is_caught_in_every_kind_of_file(project):
    files = [
        *("results/plate/figures/thresholds.png", "results/figures/pinches.png"),
        *("results/plate/curves.csv", "results/tables/summary.csv", "results/plate/mesh.vtu"),
        *("results/ring/sweep/0.5.vtu", "results/ring/export/mesh.exo"),
        *("results/ring/geometry.vtp", "results/ro-crate-metadata.json"),
    ]
    assert (project / "results/ring/geometry.vtp").stat().st_size > 1_000_000
    for file in files:
        before = (project / file).stat()
        project.flip(file)
        after = (project / file).stat()
        assert (before.st_mtime_ns, before.st_size) == (after.st_mtime_ns, after.st_size)
    report = project.verify()
    assert report.verdict is DIFFERENT
    for file in files:
        (finding,) = find(report, file)
        assert finding.remedy == f"{project.plan().command} --force -- {file}"
        assert {"SHA-256"} == {text.split()[0] for text in (finding.found, finding.expected)}
    assert len(merge(report.findings)) == len(files), "and nothing else"


def test_edited_records_are_caught(project):
    changes = {
        "plate/ingest": {"step": "quality"},
        "plate/sample": {"model": "ring"},
        "plate/persistence": {"parameters": {"samples": 8}},
        "plate/select": {"code": {"script": "workflow/scripts/select.py", "sha256": 64 * "0"}},
        "plate/mesh": {"inputs": []},
        "plate/quality": {"outputs": []},
        "plate/export": {"extra": 1},
        "plate/simulate": {"outputs": [1]},
    }
    for key, change in changes.items():
        project.edit_record(
            f"{RECORDS}/{key}.json", lambda what, change=change: what.update(change)
        )
    with_another_layout = f"{RECORDS}/ring/mesh.json"
    text = json.dumps(json.loads((project / with_another_layout).read_text()))
    project.write(with_another_layout, text.encode())
    report = project.verify()
    for key in changes:
        assert report.outcomes[key] is DIFFERENT, key
    assert find(report, with_another_layout)[0].found == "was not written by a workflow step"


def test_edited_digests_and_sizes_in_records_are_caught(project):
    edited = []
    for key, entries, part, value in (
        ("plate/mesh", "inputs", "sha256", 64 * "0"),
        ("plate/sweep", "outputs", "sha256", 64 * "0"),
        ("ring/mesh", "inputs", "size", 1),
        ("ring/sweep", "outputs", "size", 1),
    ):

        def change(what, entries=entries, part=part, value=value):
            what[entries][0][part] = value
            edited.append(what[entries][0]["path"])

        project.edit_record(f"{RECORDS}/{key}.json", change)
    report = project.verify()
    for file in edited:
        assert find(report, file)[0].outcome is DIFFERENT


def test_a_table_forged_together_with_its_record_is_caught(project):
    table = "results/plate/curves.csv"
    project.edit(table, "0.", "0.9")

    def forge(what):
        for entry in what["outputs"]:
            entry.update(state_of(project, entry["path"]))

    project.edit_record(f"{RECORDS}/plate/persistence.json", forge)
    report = project.verify()
    assert report.outcomes["plate/persistence"] is DIFFERENT, "the lock knows better"
    assert report.outcomes["plate/select"] is DIFFERENT, "it has read another table"
    assert any("as locked, equality exact" in finding.expected for finding in find(report, table))


def test_a_changed_source_and_a_register_that_disagrees_are_caught(project):
    digest = state_of(project, "data_sources/ring.stl")["sha256"]
    project.edit("data_sources/register.csv", digest, 64 * "0")
    project.edit("data_sources/plate.svg", "40", "41")
    report = project.verify()
    (changed,) = find(report, "data_sources/plate.svg")
    (disagrees,) = [f for f in merge(report.findings) if f.file == "data_sources/ring.stl"]
    assert "restore the source file" in changed.remedy
    assert "according to data_sources/register.csv" in disagrees.expected


def test_a_source_that_is_gone_is_caught(project):
    (project / "data_sources/plate.svg").unlink()
    report = project.verify()
    assert report.verdict is DIFFERENT
    assert find(report, "data_sources/plate.svg")[0].found == "the file does not exist"


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("threshold: 0.5", "threshold: 0.6", "goal.threshold"),
        ("    unit: mm\n    grid: {cells: 32}", "    grid: {cells: 32}", "lengths.unit"),
    ],
)
def test_a_changed_parameter_is_caught(project, old, new, key):
    project.edit("config/config.yaml", old, new)
    report = project.verify()
    finding = find(report, f"parameter {key}")[0]
    assert finding.outcome is DIFFERENT
    assert "--forcerun results/provenance/plate/" in finding.remedy
    assert not any(step.startswith("ring/") for step, outcome in report.outcomes.items() if outcome)


def test_a_constant_three_imports_deep_is_caught(checkout):
    # The script imports certificate, which imports meshes.checks, which imports this.
    file = "tusqh/meshes/hanging_nodes.py"
    checkout.edit(file, "import numpy as np", "import numpy as np\n\n_DEEP = 1")
    report = checkout.verify()
    (finding,) = find(report, file)
    assert finding.outcome is DIFFERENT
    assert report.outcomes["plate/mesh"] is DIFFERENT
    assert report.outcomes["plate/sample"] is SAME, "sampling does not reach it"


def test_a_changed_script_is_caught_and_concerns_its_step_alone(checkout):
    name = "workflow/scripts/figure_pinches.py"
    checkout.edit(name, "import pandas as pd", "import pandas as pd\n\n_SCALE = 1")
    report = checkout.verify()
    assert [f.file for f in find(report, "workflow/scripts")] == [name]
    assert [k for k, out in report.outcomes.items() if out] == ["figure_pinches", "crate"]


def test_another_version_of_a_package_is_caught(project, monkeypatch):
    other = installed_versions() | {"numpy": "1.0"}
    monkeypatch.setattr(check, "installed_versions", lambda: other)
    monkeypatch.setattr(compare, "installed_versions", lambda: other)
    report = project.verify()
    assert report.verdict is CANNOT_TELL
    (finding,) = find(report, "environment")
    assert "numpy 1.0" in finding.found
    assert f"numpy {installed_versions()['numpy']}" in finding.expected
    assert "pip install -r requirements.lock" in finding.remedy


def test_a_claim_that_changes_its_status_is_caught(checkout):
    checkout.edit("workflow/claims.yaml", "expected: 0.70710678", "expected: 1.70710678")
    report = checkout.verify()
    (finding,) = find(report, "claim quads-are-well-shaped")
    assert finding.outcome is DIFFERENT
    assert finding.found.startswith("refuted: ")
    assert "a margin of -" in finding.found
    assert finding.expected.startswith("holds: ")


def accept_as_refuted(checkout, name):
    """Make ``refuted`` the accepted status of a claim that holds."""
    text = (checkout / "workflow/claims.yaml").read_text()
    claim = text[text.index(f"- id: {name}") :]
    claim = claim[: claim.index("accepted: holds")]
    checkout.edit("workflow/claims.yaml", f"{claim}accepted: holds", f"{claim}accepted: refuted")


def test_a_refuted_claim_that_was_accepted_is_not_a_difference(checkout):
    accept_as_refuted(checkout, "quads-are-well-shaped")
    checkout.edit("workflow/claims.yaml", "expected: 0.70710678", "expected: 1.70710678")
    report = checkout.verify()
    assert not [f for f in report.findings if f.file.startswith("claim ")]


def test_a_lock_is_refused_while_a_claim_has_another_status(checkout):
    accept_as_refuted(checkout, "prediction-is-measurement")
    succeed(checkout.folder, snakefile=checkout.snakefile, PYTHONPATH=str(checkout.folder))
    with pytest.raises(ProvenanceError, match=r"claim prediction-is-measurement: holds: "):
        require_lockable(checkout.plan(), read_records())


def test_deleted_and_swapped_outputs_are_caught(project):
    deleted = ["results/plate/mesh.vtu", "results/tables/claims.csv"]
    swapped = ["results/ring/figures/panels.png", "results/ring/figures/temperature.png"]
    for file in deleted:
        (project / file).unlink()
    contents = [(project / file).read_bytes() for file in swapped]
    for file, content in zip(swapped, reversed(contents), strict=True):
        project.write(file, content)
    report = project.verify()
    assert {find(report, file)[0].found for file in deleted} == {"the file does not exist"}
    assert all(find(report, file)[0].outcome is DIFFERENT for file in deleted + swapped)


def test_missing_steps_and_another_lock_cannot_be_told(project):
    shutil.rmtree(project / f"{RECORDS}/ring")
    (project / "results/lock.json").unlink()
    report = project.verify()
    assert report.verdict is CANNOT_TELL
    assert report.outcomes["plate/mesh"] is SAME
    assert report.outcomes["ring/mesh"] is CANNOT_TELL
    assert all("--forcerun" in f.remedy for f in find(report, "provenance/ring"))
    assert "tusqh lock" in find(report, "results/lock.json")[0].remedy


def edit_lock(project, change):
    """Let a function change the lock, and write it as somebody would who edits it."""
    lock = json.loads((project / "results/lock.json").read_text())
    change(lock)
    (project / "results/lock.json").write_text(json.dumps(lock))


def test_what_only_the_lock_or_only_the_workflow_has_cannot_be_told(project):
    def change(lock):
        del lock["steps"]["plate/mesh"]["outputs"]["results/plate/mesh.vtu"]
        lock["steps"]["plate/mesh"]["outputs"]["results/plate/old.vtu"] = {
            "equality": "exact",
            "sha256": 64 * "0",
        }
        lock["steps"]["cow/mesh"] = lock["steps"]["plate/mesh"]
        lock["sources"]["data_sources/plate.svg"] = 64 * "0"

    edit_lock(project, change)
    report = project.verify()
    assert report.verdict is CANNOT_TELL
    assert "does not contain the file" in find(report, "results/plate/mesh.vtu")[0].found
    assert "does not write it today" in find(report, "results/plate/old.vtu")[0].found
    assert "does not have today" in find(report, "results/lock.json")[0].found
    assert any(f.file == "data_sources/plate.svg" and f.outcome is SAME for f in report.findings)


@pytest.mark.parametrize(
    "change",
    [
        lambda lock: lock.update(environment={}),
        lambda lock: lock.update(code=[]),
        lambda lock: lock["steps"].update({"plate/mesh": None}),
        lambda lock: lock["steps"]["plate/mesh"].pop("parameters"),
        lambda lock: lock["steps"]["plate/mesh"]["outputs"]["results/plate/mesh.vtu"].pop("sha256"),
        lambda lock: lock["steps"]["plate/mesh"]["outputs"]["results/plate/mesh.vtu"].update(
            {"equality": "bogus"}
        ),
        lambda lock: lock["steps"]["plate/mesh"]["outputs"]["results/plate/mesh.vtu"].update(
            {"content": {}}
        ),
    ],
)
def test_a_broken_lock_is_explained(project, change):
    edit_lock(project, change)
    with pytest.raises(ConfigError, match="cannot be read as a lock"):
        project.verify()


@pytest.mark.parametrize(
    "change",
    [
        lambda what: what.update(outputs=5),
        lambda what: what.update(outputs=None),
        lambda what: what["inputs"][0].update(path=5),
        lambda what: what.update(code="x"),
        lambda what: what.update(code={}),
        lambda what: what.update(parameters=[]),
        lambda what: what.pop("model"),
    ],
)
def test_a_broken_record_is_a_finding(project, change):
    project.edit_record(f"{RECORDS}/plate/mesh.json", change)
    report = project.verify()
    (finding,) = find(report, f"{RECORDS}/plate/mesh.json")
    assert "does not follow the schema" in finding.found


@pytest.mark.parametrize("how", ['{"seconds": "x"}', '{"seconds": null}', "[]", ""])
def test_how_a_step_went_is_no_evidence(project, how):
    (project / f"{RECORDS}/plate/mesh.how.json").write_text(how)
    assert project.verify().verdict is SAME


@pytest.mark.parametrize("content", [b"model,file\n", b"\xff", b""])
def test_a_broken_register_is_explained(project, content):
    (project / "data_sources/register.csv").write_bytes(content)
    with pytest.raises(ProvenanceError, match=r"register\.csv"):
        read_register(project.folder)


@pytest.mark.parametrize("folder", ["results", RECORDS])
def test_without_results_or_records_nothing_can_be_told(project, folder):
    shutil.rmtree(project / folder)
    report = project.verify()
    assert report.verdict is CANNOT_TELL
    assert set(report.outcomes.values()) == {CANNOT_TELL}


def test_what_means_nothing_in_the_code_is_not_caught(checkout):
    checkout.edit(
        "tusqh/grid/background.py", "import numpy as np", "import numpy as np  # the arrays"
    )
    checkout.edit("tusqh/grid/background.py", '"""', '"""Really: ')
    checkout.edit("workflow/scripts/mesh.py", "from pathlib", "# what\n\nfrom pathlib")
    checkout.edit("workflow/scripts/mesh.py", "from pathlib", '"A mesh."\nfrom pathlib')
    checkout.edit("workflow/scripts/docs.py", '"%d files"', "'%d files'")
    checkout.edit("workflow/rules/mesh.smk", "rule mesh:", "# the mesh\nrule mesh:")
    checkout.edit("workflow/claims.yaml", "- id: quads", "# squares\n- id: quads")
    checkout.edit("README.md", "# Tusqh", "# Tusqh!")
    report = checkout.verify()
    assert report.verdict is SAME, merge(report.findings)


def test_what_means_nothing_in_the_results_is_not_caught(project):
    project.edit("config/config.yaml", "{cells: 32}", "{cells: 32.0}")
    project.edit("config/config.yaml", "0.875, 1.0]", "0.875, 1]")
    project.edit("config/config.yaml", "threshold: 0.5", "threshold: 5.0e-1")
    project.edit(f"{RECORDS}/plate/mesh.how.json", '"host"', '"machine"')
    for path in project.folder.rglob("*"):
        if path.is_file():
            os.utime(path)
    shutil.copytree(project / f"{RECORDS}/plate", project / f"{RECORDS}/old")
    report = project.verify()
    assert report.verdict is SAME, merge(report.findings)
    assert any("do not need" in f.found for f in report.findings), "a remark, no more"
