"""The record every step leaves: what it read, wrote and used, and how it ran.

Two files: `what` is the same wherever and whenever the step is repeated; `how` has times, host
and versions in use.  Both appear only after the step succeeded.
"""

from __future__ import annotations

import logging
import os
import platform
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from tusqh.atomic import write_text
from tusqh.errors import TusqhError
from tusqh.provenance.environment import environment_fingerprint, installed_versions
from tusqh.provenance.hashing import canonical_json, hash_file

#: Names of the two outputs of every rule that are records themselves.
RECORD_OUTPUTS = ("record", "record_how")


@contextmanager
def recorded(snakemake: Any) -> Iterator[logging.Logger]:
    """Run the body of a rule's script: log to the rule's log, record it when it succeeded.

    A `TusqhError` ends the process with its message instead of a traceback.

    Parameters
    ----------
    snakemake
        The object that Snakemake gives to scripts.  The rule has the outputs `record` and
        `record_how`, a log, and all it depends on as inputs and params.
    """
    logger = _logger(Path(snakemake.log[0]), _label(snakemake))
    started = datetime.now(UTC)
    clock = time.perf_counter()
    try:
        yield logger
    except TusqhError as error:
        logger.error("error in %s", error)
        sys.exit(1)
    seconds = time.perf_counter() - clock
    versions = installed_versions()
    what = {
        "step": snakemake.rule,
        "model": snakemake.wildcards.get("model"),
        "parameters": dict(snakemake.params.items()),
        "inputs": [_describe(Path(p)) for p in sorted(set(snakemake.input))],
        "outputs": [_describe(Path(p)) for p in sorted(_results(snakemake.output))],
        "environment": environment_fingerprint(versions),
    }
    how = {
        "started": started.isoformat(timespec="seconds"),
        "seconds": round(seconds, 3),
        "host": platform.node(),
        "platform": platform.platform(),
        "processors": os.cpu_count(),
        "threads": snakemake.threads,
        "python": platform.python_version(),
        "versions": versions,
        "command": sys.argv,
        **_git_state(),
    }
    write_text(Path(snakemake.output.record), canonical_json(what))
    write_text(Path(snakemake.output.record_how), canonical_json(how))
    logger.info("done in %.1f s", seconds)


def _label(snakemake: Any) -> str:
    model = snakemake.wildcards.get("model")
    return f"{snakemake.rule} {model}" if model else str(snakemake.rule)


def _logger(path: Path, label: str) -> logging.Logger:
    """Return the logger of the package, writing to the rule's log and to the terminal."""
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


def _describe(path: Path) -> dict[str, Any]:
    return {"path": path.as_posix(), "sha256": hash_file(path), "size": path.stat().st_size}


def _git_state() -> dict[str, Any]:
    """Return the commit checked out and whether files differ from it; None without git."""
    try:
        commit = _git("rev-parse", "HEAD")
        return {"commit": commit, "dirty": bool(_git("status", "--porcelain"))}
    except (OSError, subprocess.CalledProcessError):
        return {"commit": None, "dirty": None}


def _git(*arguments: str) -> str:
    done = subprocess.run(["git", *arguments], capture_output=True, check=True, text=True)
    return done.stdout.strip()
