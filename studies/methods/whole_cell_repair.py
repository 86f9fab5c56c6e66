"""Repair pinches by adding and removing whole cells, as Sculpt does.

Owen et al. (2017) describe the idea but no rules; the rules here are the simplest ones.  At every
pinch in turn, the cells around the vertex change to the cheapest neighbourhood without a pinch,
where changing a cell costs the distance of its fraction to the threshold.  This may create adjacent
pinches, so the sweep over all vertices is repeated.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from tusqh.antialias.pinches import find_pinches, pinch_table
from tusqh.grid import BoolArray, FloatArray

#: A repair that has not ended after this number of sweeps is in a cycle.
MAX_SWEEPS = 100

#: Smallest cost of changing a cell, so that among equally good repairs the smallest is chosen.
_LEAST_COST = 2.0**-20


@dataclass(frozen=True)
class Repair:
    """The result of a repair by whole cells.

    Parameters
    ----------
    kept
        Kept cells, shape n.
    sweeps
        Number of sweeps over all vertices.
    has_ended
        Whether no pinch is left.
    changes
        Total number of changes; a cell can change more than once.
    """

    kept: BoolArray
    sweeps: int
    has_ended: bool
    changes: int


def repair_by_cells(kept: BoolArray, fractions: FloatArray, *, threshold: float) -> Repair:
    """Return the repair of cells, which removes pinches by adding and removing whole cells.

    Parameters
    ----------
    kept
        Kept cells, shape n.
    fractions
        Their volume fractions, shape n, dimensionless.
    threshold
        Volume-fraction threshold.

    Examples
    --------
    Among two diagonal cells and two empty ones, the cell nearest to the threshold changes.

    >>> kept = np.eye(2, dtype=bool)
    >>> repair = repair_by_cells(kept, np.array([[1.0, 0.4], [0.1, 0.8]]), threshold=0.5)
    >>> repair.kept.tolist(), repair.sweeps, repair.has_ended
    ([[True, True], [False, True]], 1, True)
    """
    cost = np.abs(fractions - threshold) + _LEAST_COST
    padded = np.pad(kept, 1)
    shape = np.array(padded.shape)
    strides = np.append(np.cumprod(shape[:0:-1])[::-1], 1)
    bits = np.arange(2**kept.ndim)
    offsets = sum((bits >> axis & 1) * strides[axis] for axis in range(kept.ndim))
    lowest = np.argwhere(np.ones(shape - 1, dtype=bool)) @ strides
    flat = padded.ravel().copy()
    sweeps, changes = _sweep(
        flat,
        np.pad(cost, 1, constant_values=np.inf).ravel(),
        lowest,
        np.asarray(offsets, dtype=np.int64),
        pinch_table(kept.ndim).copy(),
        MAX_SWEEPS,
    )
    repaired = flat.reshape(padded.shape)[(slice(1, -1),) * kept.ndim]
    return Repair(repaired, int(sweeps), not find_pinches(repaired).any(), int(changes))


@numba.njit(cache=True)
def _sweep(kept, cost, lowest, offsets, is_pinch, max_sweeps):  # type: ignore[no-untyped-def]
    """Change `kept` in place, and return the numbers of sweeps with changes and of changes."""
    n_around, n_changes = len(offsets), 0
    for done in range(max_sweeps):
        n_before = n_changes
        for first in lowest:
            code = 0
            for bit in range(n_around):
                code |= int(kept[first + offsets[bit]]) << bit
            if not is_pinch[code]:
                continue
            best, best_cost = code, np.inf
            for other in range(len(is_pinch)):
                if is_pinch[other]:
                    continue
                total = 0.0
                for bit in range(n_around):
                    if (code ^ other) >> bit & 1:
                        total += cost[first + offsets[bit]]
                if total < best_cost:
                    best, best_cost = other, total
            for bit in range(n_around):
                if (code ^ best) >> bit & 1:
                    kept[first + offsets[bit]] = not kept[first + offsets[bit]]
                    n_changes += 1
        if n_changes == n_before:
            return done, n_changes
    return max_sweeps, n_changes
