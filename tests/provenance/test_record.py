"""A record appears after success only, and its `what` part repeats byte for byte."""

import json
import logging
from types import SimpleNamespace

import PIL.Image
import pytest

from provenance.environment import environment_fingerprint, installed_versions
from provenance.record import recorded
from provenance.stamp import read_mark, stamp
from tusqh.atomic import replacing
from tusqh.errors import MeshError
from tusqh.hashing import hash_file


class Files(list):
    """A list with names, as Snakemake gives it to scripts."""

    def __init__(self, **named):
        super().__init__(named.values())
        self.__dict__.update(named)


@pytest.fixture
def job(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in.csv").write_text("1,2\n")
    yield SimpleNamespace(
        rule="mesh",
        wildcards={"model": "plate"},
        input=Files(table="in.csv"),
        output=Files(mesh="out.vtu", record="what.json", record_how="how.json"),
        params={"min_cells": 4, "code": {"script": "workflow/scripts/mesh.py", "sha256": "ab"}},
        log=["logs/mesh.log"],
        threads=1,
    )
    logger = logging.getLogger("tusqh")
    for handler in logger.handlers[:]:
        handler.close()
        logger.removeHandler(handler)


def run(job, tmp_path):
    with recorded(job) as log:
        log.info("working")
        (tmp_path / "out.vtu").write_text("mesh")
    return (tmp_path / "what.json").read_text()


def test_a_record_says_what_was_read_written_and_used(job, tmp_path):
    what = json.loads(run(job, tmp_path))
    assert (what["step"], what["model"]) == ("mesh", "plate")
    assert what["parameters"] == {"min_cells": 4}
    digest = hash_file(tmp_path / "in.csv")
    assert what["inputs"] == [{"path": "in.csv", "sha256": digest, "size": 4}]
    assert [entry["path"] for entry in what["outputs"]] == ["out.vtu"]
    how = json.loads((tmp_path / "how.json").read_text())
    assert how["versions"]["numpy"]
    assert "started" in how
    assert "working" in (tmp_path / "logs/mesh.log").read_text()


def test_the_what_part_repeats_byte_for_byte(job, tmp_path):
    assert run(job, tmp_path) == run(job, tmp_path)


def test_a_failed_step_leaves_its_message_and_no_record(job, tmp_path):
    with pytest.raises(SystemExit), recorded(job):
        raise MeshError("it broke", where="plate", expected="whole", remedy="glue")
    assert "error in plate: it broke" in (tmp_path / "logs/mesh.log").read_text()
    assert not (tmp_path / "what.json").exists()
    assert not (tmp_path / "how.json").exists()


def test_a_failed_write_leaves_the_old_file_and_no_litter(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text("old")
    with pytest.raises(FileNotFoundError), replacing(path) as temporary:
        (temporary.write_text("half"), (tmp_path / "gone").read_text())
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["table.csv"]


def test_the_fingerprint_moves_with_a_version():
    versions = installed_versions()
    assert {"numpy", "mfem", "scipy", "libigl", "tusqh"} <= set(versions)
    other = versions | {"numpy": "0.0.1"}
    assert environment_fingerprint(versions) != environment_fingerprint(other)
    assert environment_fingerprint(versions) == environment_fingerprint(dict(versions))


def test_figures_get_a_mark_and_copies_keep_theirs(job, tmp_path):
    job.output = Files(one="a.png", other="b.svg", **vars(job.output))
    mark = {"step": "figure_cow", "file": "results/cow/a.png"}
    with recorded(job):
        (tmp_path / "out.vtu").write_text("mesh")
        PIL.Image.new("RGB", (4, 4)).save("a.png")
        stamp(tmp_path / "a.png", mark)
        (tmp_path / "b.svg").write_text("<svg/>\n")
    assert read_mark(tmp_path / "a.png") == mark
    found = read_mark(tmp_path / "b.svg")
    assert (found["step"], found["model"], found["file"]) == ("mesh", "plate", "b.svg")
