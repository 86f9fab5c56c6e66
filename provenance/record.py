"""Record a step: what it read, wrote and used, and how it ran.

A record consists of two files: `what` is the same whenever and wherever the step is repeated; `how`
contains times, host and installed versions.  Both are written only after the step has succeeded.
"""

from __future__ import annotations

import logging
import os
import platform
import subprocess
import sys
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from provenance.code import PACKAGE_ROOT
from provenance.environment import environment_fingerprint, installed_versions
from provenance.stamp import MARKED, read_mark, source_mark, stamp
from tusqh.atomic import remove_leftovers, write_text
from tusqh.errors import TusqhError
from tusqh.geometry.packaged import PACKAGE, locate
from tusqh.hashing import canonical_json, hash_file
from tusqh.machine import peak_memory

#: The two outputs of each rule that hold its record.
RECORD_OUTPUTS = ("record", "record_how")


@contextmanager
def recorded(snakemake: Any) -> Iterator[logging.Logger]:
    """Run the body of a rule's script with its log, and record the step after it has succeeded.

    Figures get a mark of their source, see `provenance.stamp`.  A `TusqhError` ends the process
    with its message instead of a traceback.

    Parameters
    ----------
    snakemake
        The object that Snakemake passes to scripts.  The rule has the outputs `record` and
        `record_how`, a log and the parameter `code`; its inputs and parameters contain everything
        on which the script depends.

    Yields
    ------
    logging.Logger
        The logger of tusqh, which writes to the log of the rule and to the terminal.
    """
    logger = _logger(Path(snakemake.log[0]), _label(snakemake))
    started = datetime.now(UTC)
    clock = time.perf_counter()
    for path in snakemake.output:
        remove_leftovers(Path(path))
    try:
        yield logger
    except TusqhError as error:
        logger.error("error in %s", error)
        sys.exit(1)
    done = time.perf_counter()
    versions = installed_versions()
    what = _what(snakemake, versions)
    how = {
        "started": started.isoformat(timespec="seconds"),
        "host": platform.node(),
        "platform": platform.platform(),
        "processors": os.cpu_count(),
        "threads": snakemake.threads,
        "python": platform.python_version(),
        "versions": versions,
        "command": sys.argv,
        **_git_state(),
        "seconds": round(done - clock, 3),
        "seconds_of_recording": round(time.perf_counter() - done, 3),
        # Of the whole process, with its imports and the processes that it started.
        "processor_seconds": round(sum(os.times()[:4]), 3),
        "peak_mb": round(peak_memory() / 1e6),
    }
    write_text(Path(snakemake.output.record), canonical_json(what))
    write_text(Path(snakemake.output.record_how), canonical_json(how))
    logger.info("done in %.1f s", done - clock)


def inputs_of(files: Iterable[str], parameters: dict[str, Any]) -> list[str]:
    """Return the files that a step reads, which are its inputs and files in installed packages.

    Parameters
    ----------
    files
        The inputs of the step.
    parameters
        The parameters of the step.

    Examples
    --------
    >>> inputs_of(["b.csv", "a.csv"], {"source": {"geometry": "package:pyvista/airplane.ply"}})
    ['a.csv', 'b.csv', 'package:pyvista/airplane.ply']
    """
    return sorted({*files, *_packaged(parameters)})


def _packaged(value: Any) -> set[str]:
    """Return the names of files inside packages among parameters, nested or not."""
    if isinstance(value, dict | list):
        items = value.values() if isinstance(value, dict) else value
        return set().union(*map(_packaged, items))
    return {value} if isinstance(value, str) and value.startswith(PACKAGE) else set()


def describe_file(name: str) -> dict[str, Any]:
    """Return the path, SHA-256 and size of a file, which may be inside an installed package.

    Parameters
    ----------
    name
        A path, or ``package:NAME/FILE``.
    """
    path = locate(name)
    return {"path": name, "sha256": hash_file(path), "size": path.stat().st_size}


def _what(snakemake: Any, versions: dict[str, str]) -> dict[str, Any]:
    parameters = dict(snakemake.params.items())
    code = parameters.pop("code")
    what = {
        "step": snakemake.rule,
        "model": snakemake.wildcards.get("model"),
        "parameters": parameters,
        "code": code,
        "inputs": [describe_file(path) for path in inputs_of(snakemake.input, parameters)],
        "environment": environment_fingerprint(versions),
    }
    results = sorted(_results(snakemake.output))
    for path in results:
        # A copy of a figure keeps the mark of the original.
        if Path(path).suffix in MARKED and read_mark(Path(path)) is None:
            stamp(Path(path), source_mark(what, path))
    return what | {"outputs": [describe_file(path) for path in results]}


def _label(snakemake: Any) -> str:
    model = snakemake.wildcards.get("model")
    return f"{snakemake.rule} {model}" if model else str(snakemake.rule)


def _logger(path: Path, label: str) -> logging.Logger:
    """Return the logger of tusqh, configured to write to the rule's log and to the terminal."""
    logger = logging.getLogger("tusqh")
    logger.setLevel(logging.INFO)
    path.parent.mkdir(parents=True, exist_ok=True)
    for handler in (logging.FileHandler(path, mode="w"), logging.StreamHandler()):
        handler.setFormatter(logging.Formatter(f"[{label}] %(message)s"))
        logger.addHandler(handler)
    return logger


def _results(output: Any) -> set[str]:
    """Return the outputs of a rule that are not records."""
    return set(output) - {getattr(output, name) for name in RECORD_OUTPUTS}


def _git_state() -> dict[str, Any]:
    """Return the current commit and whether files differ from it, or None without git."""
    try:
        commit = _git("rev-parse", "HEAD")
        return {"commit": commit, "dirty": bool(_git("status", "--porcelain"))}
    except (OSError, subprocess.CalledProcessError):
        return {"commit": None, "dirty": None}


def _git(*arguments: str) -> str:
    command = ["git", "-C", str(PACKAGE_ROOT), *arguments]
    return subprocess.run(command, capture_output=True, check=True, text=True).stdout.strip()
