"""Array types; shapes, units and order are documented where an array is used."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
#: Numbers of points, cells or elements, 32-bit where these are large enough.
IndexArray = NDArray[np.signedinteger]
BoolArray = NDArray[np.bool_]


def as_indices(numbers: NDArray[np.integer]) -> IndexArray:
    """Return integers as int32, or as int64 if one of them does not fit.

    Parameters
    ----------
    numbers
        Integers, any shape.

    Examples
    --------
    >>> as_indices(np.array([1, 2])).dtype, as_indices(np.array([1, 2**31])).dtype
    (dtype('int32'), dtype('int64'))
    """
    limit = 2**31
    fits = numbers.min(initial=0) >= -limit and numbers.max(initial=0) < limit
    return numbers.astype(np.int32 if fits else np.int64, copy=False)
