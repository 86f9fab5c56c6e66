"""The command line writes whole lines to its streams, and nothing from other libraries."""

import os
import re
import subprocess
import sys

import pandas as pd
import pytest
import trimesh
from samples import write_samples

from tusqh.cli.show import show

COMMAND = [sys.executable, "-W", "default", "-m", "tusqh"]
#: Runs `tusqh` once for each line of standard input, in one process.
MANY = """
import sys
from tusqh.cli.app import main

for line in sys.stdin:
    sys.argv = ["tusqh", *line.split()]
    try:
        main()
    except SystemExit as end:
        print("ended", end.code, flush=True)
"""


@pytest.fixture(scope="module")
def part(tmp_path_factory):
    """Return a box in a folder with a long name."""
    path = tmp_path_factory.mktemp("a_name_that_is_long_" * 6) / "part.stl"
    trimesh.creation.box((1, 2, 3)).export(path)
    return path


@pytest.fixture(scope="module")
def good_runs(part, tmp_path_factory):
    """Return runs on every format and export, with the warnings that Python shows."""
    folder = tmp_path_factory.mktemp("samples")
    latest = {path.suffix: path for path in write_samples(folder)}
    exports = " ".join(f"-o part.{suffix}" for suffix in ("vtu", "mesh", "msh", "exo", "inp"))
    commands = [f"mesh {path} --cells 6" for path in latest.values()]
    for path in (latest[".svg"], part):
        commands += [
            f"mesh {path} --cells 6 {exports} --results {path.parent / 'all'}",
            f"inspect {path} --cells 6",
            f"check {path.parent / 'all/mesh.vtu'}",
        ]
    words = [sys.executable, "-W", "default", "-c", MANY]
    text = "\n".join(commands)
    done = subprocess.run(words, input=text, cwd=part.parent, capture_output=True, text=True)
    assert re.findall(r"ended (\d+)", done.stdout) == ["0"] * len(commands)
    return done


@pytest.mark.slow
def test_good_runs_on_every_format_write_nothing_to_standard_error(good_runs):
    assert good_runs.stderr == ""


@pytest.mark.slow
def test_lines_are_not_wrapped_when_the_output_is_piped(good_runs, part):
    (written,) = (line for line in good_runs.stdout.splitlines() if str(part.parent) in line)
    assert written.startswith("written")
    assert written.endswith(str(part.parent / "all"))


@pytest.mark.slow
def test_tables_are_not_wrapped_when_the_output_is_piped(good_runs):
    rows = [line for line in good_runs.stdout.splitlines() if "│" in line]
    assert len(rows) > 50
    assert all(row.split("│")[1].strip() for row in rows)


@pytest.mark.skipif(os.name == "nt", reason="Windows has no SIGPIPE")
def test_a_reader_that_leaves_ends_the_command_quietly(part, tmp_path):
    reader, writer = os.pipe()
    os.close(reader)
    words = [*COMMAND, "mesh", part, "--cells", "6"]
    done = subprocess.run(words, cwd=tmp_path, stdout=writer, stderr=subprocess.PIPE, text=True)
    os.close(writer)
    assert done.returncode == 141
    assert done.stderr == ""
    # Files are written before the report is printed.
    assert [path.name for path in tmp_path.iterdir()] == ["part.vtu"]


def test_a_closed_pipe_that_is_not_an_output_stops_nothing(monkeypatch):
    from tusqh.cli import interruption

    monkeypatch.setattr(interruption, "_caught", [])
    interruption._stop_quietly(13, None)
    assert interruption.to_exit_code(0) == 0


def test_piped_tables_have_no_spaces_at_the_end_of_lines(capsys):
    show(pd.DataFrame({"count": [1], "what": ["holes"]}), title="A title that is longer")
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) > 3
    assert all(line == line.rstrip() for line in lines)
