"""Stop on a signal without leaving incomplete files; stop silently if the output has no reader."""

from __future__ import annotations

import os
import select
import signal

_caught: list[int] = []


def catch_signals() -> None:
    """Turn SIGINT, SIGTERM and SIGPIPE into an error that cleans up like any other."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _stop)
    if hasattr(signal, "SIGPIPE"):  # Windows has none.
        signal.signal(signal.SIGPIPE, _stop_quietly)


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


def _stop_quietly(number: int, _frame: object) -> None:
    """Stop where the reader of the output has gone, as `head` does; other pipes do not matter."""
    if not any(map(_has_no_reader, (1, 2))):
        return
    _caught.append(number)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in (1, 2):
        os.dup2(nowhere, stream)
    raise SystemExit(128 + number)


def _has_no_reader(stream: int) -> bool:
    """Return whether a stream is a pipe whose other end is closed."""
    watch = select.poll()
    watch.register(stream, 0)
    return any(event & select.POLLERR for _, event in watch.poll(0))


def _stop(number: int, _frame: object) -> None:
    if _caught:  # The second signal ends the process immediately.
        os._exit(128 + number)
    _caught.append(number)
    os.write(2, b"interrupted: unfinished files are removed, existing ones stay as they were\n")
    raise KeyboardInterrupt
