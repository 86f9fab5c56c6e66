"""Measure the memory that this process uses, and that the machine can still give to it."""

from __future__ import annotations

import os
import resource
import sys
import time
from pathlib import Path

_MEMORY_INFO = Path("/proc/meminfo")
_GROUP = Path("/sys/fs/cgroup")


def available_memory() -> int:
    """Return the number of bytes of memory that this process can still get.

    Returns
    -------
    int
        The smallest of three numbers: the available memory of the system (or all of its memory, if
        the system does not report it), the remainder of the limit of the control group, and the
        limit of the address space.
    """
    limits = [os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")]
    if _MEMORY_INFO.is_file():
        words = _MEMORY_INFO.read_text().split()
        if "MemAvailable:" in words:
            limits.append(1024 * int(words[words.index("MemAvailable:") + 1]))
    try:
        most = (_GROUP / "memory.max").read_text().strip()
        used = int((_GROUP / "memory.current").read_text())
        limits += [int(most) - used] if most != "max" else []
    except (OSError, ValueError):
        pass
    address_space, _ = resource.getrlimit(resource.RLIMIT_AS)
    if address_space != resource.RLIM_INFINITY:
        limits.append(address_space)
    return max(min(limits), 0)


def peak_memory() -> int:
    """Return the number of bytes of memory that this process, or a process it ran, had at most."""
    peaks = [
        resource.getrusage(w).ru_maxrss for w in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    ]
    return max(peaks) * (1 if sys.platform == "darwin" else 1024)


class Stopwatch:
    """A measurement of the time and the memory that a step takes, from now on."""

    def __init__(self) -> None:
        self._began = time.perf_counter()

    def read(self) -> dict[str, float]:
        """Return the seconds since the start, and the peak memory of the whole process.

        Returns
        -------
        dict of float
            `seconds`, and `peak_gb` in units of 2^30 bytes.
        """
        seconds = time.perf_counter() - self._began
        return {"seconds": round(seconds, 3), "peak_gb": round(peak_memory() / 2**30, 3)}
