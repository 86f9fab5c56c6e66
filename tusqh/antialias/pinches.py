"""Pinches: grid vertices at which kept cells, or empty ones, meet without sharing a face.

Paper: Anti-aliasing.  Which of the ``2**(2**dim)`` neighbourhoods are pinches is computed once
from the definition, not typed in.
"""

from __future__ import annotations

import functools
import itertools

import numpy as np

from tusqh.grid import BoolArray, IntArray


def neighbourhood_codes(kept: BoolArray) -> IntArray:
    """Return, for every grid vertex, which of its cells are kept, as the bits of a number.

    Parameters
    ----------
    kept
        Kept cells of the grid, shape n; cells outside the grid are empty.

    Returns
    -------
    codes
        Shape ``n + 1``.  Bit ``b`` belongs to the cell on the upper side along axis ``k`` when
        bit ``k`` of ``b`` is set: in 2D bits 0, 1, 2, 3 are lower left, lower right, upper
        left, upper right.

    Examples
    --------
    >>> import numpy as np
    >>> neighbourhood_codes(np.array([[True]])).tolist()  # doctest: +NORMALIZE_WHITESPACE
    [[8, 2], [4, 1]]
    """
    padded = np.pad(kept, 1)
    dim = kept.ndim
    codes = np.zeros(tuple(n + 1 for n in kept.shape), dtype=np.int64)
    for bit in range(2**dim):
        upper = [bit >> axis & 1 for axis in range(dim)]
        window = tuple(slice(u, u + n + 1) for u, n in zip(upper, kept.shape, strict=True))
        codes |= padded[window].astype(np.int64) << bit
    return codes


@functools.cache
def pinch_table(dim: int) -> BoolArray:
    """Return, for every neighbourhood code, whether its vertex is a pinch.

    A vertex is a pinch when its kept cells, or its empty cells, are not connected through
    shared faces within the neighbourhood (algorithm notes 4.1).  In 2D these are the two
    diagonals:

    >>> pinch_table(2).nonzero()[0].tolist()
    [6, 9]
    >>> int(pinch_table(3).sum())
    128
    """
    n_cells = 2**dim
    table = np.zeros(2**n_cells, dtype=bool)
    for code in range(2**n_cells):
        kept = [b for b in range(n_cells) if code >> b & 1]
        empty = [b for b in range(n_cells) if not code >> b & 1]
        table[code] = _n_face_components(kept) > 1 or _n_face_components(empty) > 1
    table.setflags(write=False)
    return table


def _n_face_components(cells: list[int]) -> int:
    """Count the components of cells of a neighbourhood that are joined through faces."""
    parent = {c: c for c in cells}

    def root(c: int) -> int:
        while parent[c] != c:
            c = parent[c]
        return c

    for a, b in itertools.combinations(cells, 2):
        if (a ^ b).bit_count() == 1:
            parent[root(a)] = root(b)
    return sum(parent[c] == c for c in cells)


def find_pinches(kept: BoolArray) -> BoolArray:
    """Return the pinch vertices of a set of kept cells, shape ``n + 1``.

    Examples
    --------
    >>> import numpy as np
    >>> find_pinches(np.array([[True, False], [False, True]])).astype(int)[1].tolist()
    [0, 1, 0]
    """
    return pinch_table(kept.ndim)[neighbourhood_codes(kept)]
