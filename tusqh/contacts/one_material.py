"""The fractions of one material, in the form that contacts need.

One material is the case of two materials of which the second is the void: a cell is kept where
``f >= t``, because with the thresholds ``t`` and ``1 - t`` this is where the material wins.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tusqh.contacts.material_fractions import FULL
from tusqh.grid import BackgroundGrid, IntArray
from tusqh.sampling.fractions import VolumeFractions

#: The labels of kept and of empty cells.
MATERIAL, VOID = 0, 1


@dataclass(frozen=True)
class OneMaterial:
    """The fractions of one material and the void, without a copy.

    Parameters
    ----------
    fractions
        Volume fractions of the material.
    """

    fractions: VolumeFractions

    @property
    def grid(self) -> BackgroundGrid:
        """The background grid, of shape n."""
        return self.fractions.grid

    @property
    def void(self) -> int:
        """The label of the void."""
        return VOID

    def multiples_at(self, places: IntArray, labels: NDArray[np.int32]) -> IntArray:
        """Return fractions as `MaterialFractions.multiples_at` does.

        Parameters
        ----------
        places
            Flat places of the doubled grid, shape (r,).
        labels
            `MATERIAL` or `VOID`, shape (r, c).
        """
        own = self.fractions.multiples.ravel()[places].astype(np.int64).clip(0, FULL)[:, None]
        return np.asarray(np.where(labels == MATERIAL, own, FULL - own))


def thresholds_of(threshold: float) -> IntArray:
    """Return the thresholds of material and void in multiples of 2**-20.

    Parameters
    ----------
    threshold
        Volume-fraction threshold in (0, 1].

    Examples
    --------
    >>> (thresholds_of(0.25) * 4 // FULL).tolist()
    [1, 3]
    """
    # Fractions are multiples of 2**-20, so rounding up keeps the same cells.
    own = int(np.ceil(threshold * FULL))
    return np.array([own, FULL - own], dtype=np.int64)
