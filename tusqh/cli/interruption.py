"""Stop on Ctrl-C or a scheduler's signal with a message, and leave no incomplete files."""

from __future__ import annotations

import os
import signal

_caught: list[int] = []


def catch_signals() -> None:
    """Turn SIGINT and SIGTERM into an error that cleans up like any other."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _stop)


def stop_if_interrupted() -> None:
    """Raise again when a library swallowed the error, as some do while they are imported."""
    if _caught:
        raise KeyboardInterrupt


def to_exit_code(code: str | int | None) -> str | int | None:
    """Return the exit code of a command; of one that was stopped 128 plus the signal, as in shells.

    Parameters
    ----------
    code
        The exit code without a signal.
    """
    return 128 + _caught[0] if _caught else code


def _stop(number: int, _frame: object) -> None:
    if _caught:  # The second signal ends the process immediately.
        os._exit(128 + number)
    _caught.append(number)
    os.write(2, b"interrupted: unfinished files are removed, existing ones stay as they were\n")
    raise KeyboardInterrupt
