"""Progress on the terminal: one line that says what happens now and how long it will take."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, SpinnerColumn, TaskID, TextColumn, TimeRemainingColumn
from rich.progress import Progress as Bars

from tusqh.cli.compilation import announced
from tusqh.cli.interruption import stop_if_interrupted
from tusqh.progress import Progress, Report


@contextmanager
def shown() -> Iterator[Progress]:
    """Yield a progress function whose line is cleared when the work is done.

    It is drawn on the standard error stream, and only where that is a terminal.
    """
    console = Console(stderr=True)
    if not console.is_terminal:  # Even a disabled bar ends with an empty line.
        yield _silent
        stop_if_interrupted()
        return
    columns = (
        SpinnerColumn(),
        TextColumn("{task.description}"),
        BarColumn(),
        TimeRemainingColumn(elapsed_when_finished=True),
    )
    with Bars(*columns, console=console, transient=True) as bars, announced(console.print):
        current: list[TaskID] = []

        def progress(what: str) -> Report:
            stop_if_interrupted()
            if current:
                bars.remove_task(current.pop())
            task = bars.add_task(what, total=None)
            current.append(task)

            def report(done: int, total: int) -> None:
                stop_if_interrupted()
                bars.update(task, completed=done, total=total)

            return report

        yield progress
    stop_if_interrupted()


def _silent(_what: str) -> Report:
    """Show nothing; long steps still stop on a signal."""

    def report(_done: int, _total: int) -> None:
        stop_if_interrupted()

    stop_if_interrupted()
    return report
