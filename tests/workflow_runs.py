"""Run Snakemake in a folder, as a user does."""

import os
import subprocess
import sys
from pathlib import Path

SNAKEFILE = Path(__file__).resolve().parent.parent / "Snakefile"


def start(folder, *arguments, snakefile=SNAKEFILE, cores=2, **environment):
    """Start snakemake in a folder, in a separate session that can be killed as a whole."""
    command = [sys.executable, "-m", "snakemake", "--snakefile", str(snakefile)]
    command += [] if cores is None else ["--cores", str(cores)]
    return subprocess.Popen(
        [*command, *arguments],
        cwd=folder,
        env=os.environ | environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )


def run(folder, *arguments, **options):
    """Run snakemake to its end, and return its exit code and its messages."""
    process = start(folder, *arguments, **options)
    messages, _ = process.communicate()
    return process.returncode, messages


def succeed(folder, *arguments, **options):
    """Run snakemake to its end, which must be a success, and return its messages."""
    code, messages = run(folder, *arguments, **options)
    assert code == 0, messages
    return messages


def fail(folder, *arguments, **options):
    """Run snakemake to its end, which must be a failure, and return its messages."""
    code, messages = run(folder, *arguments, **options)
    assert code != 0, messages
    return messages
