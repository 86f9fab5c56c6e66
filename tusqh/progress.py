"""Log the progress of long work, at most once in two seconds, so that short work is silent."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable

_SECONDS_BETWEEN_LINES = 2.0

#: Called with (done, total) as the work progresses.
Report = Callable[[int, int], None]

#: Called with the name of a task before it starts; returns the function that reports on it.
Progress = Callable[[str], Report]


def log_progress(what: str) -> Report:
    """Return a function of (done, total) that logs the progress of a task.

    Parameters
    ----------
    what
        The name of the task in the log.
    """
    logger = logging.getLogger("tusqh")
    started = time.monotonic()
    last = started

    def report(done: int, total: int) -> None:
        nonlocal last
        now = time.monotonic()
        if now - last >= _SECONDS_BETWEEN_LINES and done < total:
            last = now
            left = (now - started) * (total - done) / max(done, 1)
            logger.info("%s: %d %%, about %.0f s left", what, 100 * done // total, left)

    return report
