"""The score of one material against all others, as a field of volume fractions."""

from __future__ import annotations

import numba
import numpy as np

from tusqh.contacts.material_fractions import FULL, MaterialFractions
from tusqh.grid import FloatArray
from tusqh.sampling.doubled_grid import Multiples


def score_field(fractions: MaterialFractions, material: int, thresholds: FloatArray) -> Multiples:
    """Return the share of a material in its own score and the best other score, at every place.

    With the fractions f and thresholds t of all materials, this is ``f / (f + max f_j / t_j)`` over
    all others j.  It does not depend on the material's own threshold, and the material wins a cell
    where it is at least ``t / (1 + t)``, except in ties.  So filtration, Betti numbers and
    plateaus apply to it as to the volume fractions of a single material.

    Parameters
    ----------
    fractions
        Fractions of all materials.
    material
        Index of the material.
    thresholds
        Threshold of every material, shape (m,); that of the material itself does not matter.

    Returns
    -------
    multiples
        Multiples of `tusqh.sampling.doubled_grid.RESOLUTION`, shape ``2 n + 1``; 0 at places that
        decide nothing.

    Examples
    --------
    >>> from tusqh.grid import BackgroundGrid
    >>> two = [np.full((3, 3), FULL // 4), np.full((3, 3), FULL // 2)]
    >>> grid = BackgroundGrid((1, 1), 1.0, (0.0, 0.0))
    >>> found = MaterialFractions.from_multiples(grid, ["a", "b"], two)
    >>> round(score_field(found, 0, np.array([1.0, 0.5, 1.0]))[1, 1] / FULL, 6).item()
    0.2
    """
    shape = tuple(2 * n + 1 for n in fractions.grid.shape)
    entries = (fractions.start, fractions.material, fractions.multiple)
    found = _score(entries, material, np.asarray(thresholds, dtype=np.float64), FULL)
    return np.asarray(found).reshape(shape)


@numba.njit(cache=True)
def _score(entries, k, thresholds, full):  # type: ignore[no-untyped-def]
    start, material, multiple = entries
    found = np.zeros(len(start) - 1, dtype=np.int32)
    for place in range(len(found)):
        own, best = 0.0, 0.0
        for at in range(start[place], start[place + 1]):
            if material[at] == k:
                own = float(multiple[at])
            elif thresholds[material[at]] > 0:
                best = max(best, multiple[at] / thresholds[material[at]])
            elif multiple[at] > 0:
                best = np.inf
        if own > 0:
            found[place] = np.int32(np.rint(full * own / (own + best)))
    return found
