"""Damaged files cause a message or are read whole, without a traceback, crash or hang."""

import json
import subprocess
import sys

import pytest


@pytest.mark.parametrize("count", [64, pytest.param(5000, marks=pytest.mark.slow)])
def test_damaged_files_of_every_format_are_refused_or_read_as_they_say(repository, count):
    command = [sys.executable, repository / "tests/fuzzing.py", "0", str(count)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=repository)
    assert done.returncode == 0, done.stderr[-2000:]
    *faults, ends = map(json.loads, done.stdout.splitlines())
    assert not faults
    assert sum(ends.values()) == count
    assert set(ends) == {"read", "refused"}
    assert "ERR|" not in done.stderr
    assert "ERROR" not in done.stderr
