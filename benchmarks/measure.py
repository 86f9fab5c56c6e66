"""Measure the time and peak memory of a call in a fresh process."""

from __future__ import annotations

import multiprocessing
import os
import threading
import time
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any, NamedTuple

import numpy as np
import psutil

FIELDS = ["case", "cells", "ours_seconds", "other", "other_seconds", "ratio", "ours_peak_gb"]
FIELDS += ["other_peak_gb"]


class Cost(NamedTuple):
    """Wall-clock time in seconds, and the increase of peak resident memory in the call, in GB."""

    seconds: float
    peak_gb: float


def measure(
    prepare: Callable[..., Any], call: Callable[[Any], Any], warm_up: Any, *arguments: Any
) -> Cost:
    """Return the cost of ``call(prepare(*arguments))`` without that of `prepare`.

    `call` first runs on ``prepare(*warm_up)``, so that no compilation is measured.
    """
    context = multiprocessing.get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_run, args=(sender, prepare, call, warm_up, arguments))
    process.start()
    sender.close()
    try:
        return Cost(*receiver.recv())
    finally:
        process.join()


def compare(case: str, cells: int, ours: Cost, other: str = "", cost: Cost | None = None) -> dict:
    """Return one row of a benchmark's table."""
    row = {
        "case": case,
        "cells": cells,
        "ours_seconds": round(ours.seconds, 4),
        "other": other,
        "other_seconds": round(cost.seconds, 4) if cost else None,
        "ratio": round(cost.seconds / ours.seconds, 2) if cost else None,
        "ours_peak_gb": round(ours.peak_gb, 4),
        "other_peak_gb": round(cost.peak_gb, 4) if cost else None,
    }
    print("  ".join(f"{name} {value}" for name, value in row.items() if value != ""), flush=True)
    return row


def growth(rows: list[dict]) -> float:
    """Return the exponent of the growth of our time with the number of cells, by least squares."""
    cells, seconds = np.log([[row["cells"], row["ours_seconds"]] for row in rows]).T
    return float(np.polyfit(cells, seconds, 1)[0])


def _run(
    sender: Connection,
    prepare: Callable[..., Any],
    call: Callable[[Any], Any],
    warm_up: Any,
    arguments: Any,
) -> None:
    call(prepare(*warm_up))
    prepared = prepare(*arguments)
    memory = psutil.Process(os.getpid())
    before = peak = memory.memory_info().rss
    done = threading.Event()

    def watch() -> None:
        nonlocal peak
        while not done.wait(0.002):
            peak = max(peak, memory.memory_info().rss)

    watcher = threading.Thread(target=watch)
    watcher.start()
    start = time.perf_counter()
    result = call(prepared)
    seconds = time.perf_counter() - start
    peak = max(peak, memory.memory_info().rss)
    done.set()
    watcher.join()
    del result
    sender.send((seconds, (peak - before) / 1e9))
