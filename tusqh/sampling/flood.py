"""The samples that the centre of a ball reaches from outside, and those that the ball covers."""

from __future__ import annotations

import numba
import numpy as np

from tusqh.grid import FloatArray, IntArray
from tusqh.sampling.offset_scan import Marks

#: Marks of a sample: it is near the surface, so near that the centre of the ball cannot be there;
#: the centre comes there; the ball covers it.
NEAR, BLOCKED, REACHED, COVERED = 1, 2, 4, 8


def reach(marks: Marks) -> None:
    """Mark as `REACHED` the samples to which steps between free neighbours lead from the first one.

    Samples that share a face of the lattice are neighbours; those marked `BLOCKED` are not free.
    Runs of free samples along z are joined by union-find, so the time depends on the surface.

    Parameters
    ----------
    marks
        A number for each sample, shape (n_x, n_y, n_z), changed in place; the first one is free.

    Examples
    --------
    >>> marks = np.array([[[0, 2, 0]], [[0, 2, 0]]], dtype=np.uint8)
    >>> reach(marks)
    >>> marks[0].tolist()
    [[4, 2, 0]]
    """
    n = np.zeros(marks.shape[:2], dtype=np.int64)
    _count_runs(marks, n)
    start = np.concatenate([[0], np.cumsum(n.ravel())])
    first, last = np.empty(start[-1], dtype=np.int32), np.empty(start[-1], dtype=np.int32)
    _list_runs(marks, start, first, last)
    parent = np.arange(start[-1])
    _join_runs(marks.shape[0], marks.shape[1], start, first, last, parent)
    _mark_runs(marks, start, first, last, parent == 0)


def cover(marks: Marks, centres: IntArray, radii: FloatArray) -> None:
    """Mark as `COVERED` the samples in open balls.

    Parameters
    ----------
    marks
        A number for each sample, shape (n_x, n_y, n_z), changed in place.
    centres
        Samples at the centres of the balls, shape (b, 3), in order along x.
    radii
        Radii of the balls, in steps of the lattice, shape (b,).

    Examples
    --------
    >>> marks = np.zeros((3, 1, 3), dtype=np.uint8)
    >>> cover(marks, np.array([[1, 0, 1]]), np.array([1.2]))
    >>> marks[:, 0].tolist()
    [[0, 8, 0], [8, 8, 8], [0, 8, 0]]
    """
    if len(centres):
        reach_of = int(np.ceil(radii.max()))
        _cover(marks, centres, radii, reach_of)


@numba.njit(cache=True, parallel=True)
def _count_runs(marks, n):  # type: ignore[no-untyped-def]
    """Count the runs of free samples on every line along z."""
    for i in numba.prange(marks.shape[0]):
        for j in range(marks.shape[1]):
            was_free, count = False, 0
            for mark in marks[i, j]:
                is_free = mark & BLOCKED == 0
                count += is_free and not was_free
                was_free = is_free
            n[i, j] = count


@numba.njit(cache=True, parallel=True)
def _list_runs(marks, start, first, last):  # type: ignore[no-untyped-def]
    """Fill in the first and the last sample of every run."""
    n_y, n_z = marks.shape[1], marks.shape[2]
    for i in numba.prange(marks.shape[0]):
        for j in range(n_y):
            run, was_free = start[i * n_y + j], False
            for k in range(n_z):
                is_free = marks[i, j, k] & BLOCKED == 0
                if is_free and not was_free:
                    first[run] = k
                if was_free and not is_free:
                    last[run] = k - 1
                    run += 1
                was_free = is_free
            if was_free:
                last[run] = n_z - 1


@numba.njit(cache=True)
def _root(parent, run):  # type: ignore[no-untyped-def]
    """Return the lowest run joined with a run, and shorten the way to it."""
    while parent[run] != run:
        parent[run] = parent[parent[run]]
        run = parent[run]
    return run


@numba.njit(cache=True)
def _join_lines(a, b, start, first, last, parent):  # type: ignore[no-untyped-def]
    """Join the runs of two neighbouring lines that share a height."""
    i, j = start[a], start[b]
    while i < start[a + 1] and j < start[b + 1]:
        if first[i] <= last[j] and first[j] <= last[i]:
            p, q = _root(parent, i), _root(parent, j)
            if p < q:
                parent[q] = p
            else:
                parent[p] = q
        if last[i] < last[j]:
            i += 1
        else:
            j += 1


@numba.njit(cache=True)
def _join_runs(n_x, n_y, start, first, last, parent):  # type: ignore[no-untyped-def]
    """Join runs of neighbouring lines, then let every run point to its lowest one."""
    for i in range(n_x):
        for j in range(n_y):
            line = i * n_y + j
            if j > 0:
                _join_lines(line - 1, line, start, first, last, parent)
            if i > 0:
                _join_lines(line - n_y, line, start, first, last, parent)
    for run in range(len(parent)):
        parent[run] = _root(parent, run)


@numba.njit(cache=True, parallel=True)
def _mark_runs(marks, start, first, last, is_chosen):  # type: ignore[no-untyped-def]
    """Mark the samples of chosen runs as reached."""
    n_y = marks.shape[1]
    for i in numba.prange(marks.shape[0]):
        for j in range(n_y):
            for run in range(start[i * n_y + j], start[i * n_y + j + 1]):
                if is_chosen[run]:
                    for k in range(first[run], last[run] + 1):
                        marks[i, j, k] |= REACHED


@numba.njit(cache=True)
def _cover_slab(marks, centres, radii, from_, to, begin, end):  # type: ignore[no-untyped-def]
    """Cover the samples ``begin <= i < end`` along x by the balls ``from_`` to ``to``."""
    n_y, n_z = marks.shape[1], marks.shape[2]
    for b in range(from_, to):
        x, y, z = centres[b]
        n = int(radii[b])
        square = radii[b] * radii[b]
        for i in range(max(begin, x - n), min(end, x + n + 1)):
            for j in range(max(0, y - n), min(n_y, y + n + 1)):
                rest = square - (i - x) * (i - x) - (j - y) * (j - y)
                if rest <= 0:
                    continue
                m = int(np.ceil(np.sqrt(rest))) - 1
                for k in range(max(0, z - m), min(n_z, z + m + 1)):
                    marks[i, j, k] |= COVERED


@numba.njit(cache=True, parallel=True)
def _cover(marks, centres, radii, reach_of):  # type: ignore[no-untyped-def]
    """Cover samples, slab by slab along x, so that no two threads change the same sample."""
    n = marks.shape[0]
    n_slabs = min(16, n)
    for slab in numba.prange(n_slabs):
        begin, end = slab * n // n_slabs, (slab + 1) * n // n_slabs
        from_ = np.searchsorted(centres[:, 0], begin - reach_of)
        to = np.searchsorted(centres[:, 0], end + reach_of)
        _cover_slab(marks, centres, radii, from_, to, begin, end)
