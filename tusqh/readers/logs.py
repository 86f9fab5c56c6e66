"""Turn the log messages of libraries into remarks, instead of writing them to standard error."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from tusqh.geometry.remark import Remark

#: Largest number of distinct messages that are kept.
_MOST = 5


class _Collector(logging.Handler):
    """A handler that keeps the first lines of distinct messages."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.texts: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        """Keep a message unless it is already there."""
        text = (record.getMessage().splitlines() or [""])[0]
        if text not in self.texts and len(self.texts) < _MOST:
            self.texts.append(text)


@contextmanager
def collect_logs(name: str) -> Iterator[list[str]]:
    """Collect the warnings of a logger instead of writing them to standard error.

    Parameters
    ----------
    name
        The logger of the library.

    Yields
    ------
    list of str
        The messages, which are added while the context is active.
    """
    logger, collector = logging.getLogger(name), _Collector()
    was_open, handlers = logger.propagate, logger.handlers[:]
    logger.handlers[:] = [collector]
    logger.propagate = False
    try:
        yield collector.texts
    finally:
        logger.handlers[:] = handlers
        logger.propagate = was_open


def remarks_on_logs(library: str, texts: Sequence[str]) -> list[Remark]:
    """Return a remark for each message of a library.

    Parameters
    ----------
    library
        Name of the library.
    texts
        Its messages.
    """
    return [Remark("noted", f"warning of {library}: {text}", 1) for text in texts]
