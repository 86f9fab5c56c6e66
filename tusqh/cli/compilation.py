"""Say that functions are being compiled, which the first run after an installation waits for."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

#: What the first run says; numba keeps the compiled functions on disk.
MESSAGE = (
    "compiling functions for this machine; only the first run after an installation does this, "
    "and it takes about a minute"
)


@contextmanager
def announced(say: Callable[[str], Any]) -> Iterator[None]:
    """Call a function once if numba compiles anything within the block.

    Parameters
    ----------
    say
        Called with `MESSAGE` before the first function is compiled.
    """
    from numba.core import event

    class Announcer(event.Listener):
        """Announces the first compilation."""

        is_done = False

        def on_start(self, event: Any) -> None:
            """Say once that compilation has begun."""
            if not self.is_done:
                self.is_done = True
                say(MESSAGE)

        def on_end(self, event: Any) -> None:
            """Say nothing."""

    with event.install_listener("numba:compile", Announcer()):
        yield
