r"""Compute the fractions of a straight gap between two half-spaces, in any orientation and offset.

This is the setting of the paper's theorem: there is material everywhere except in a slab of width
``L`` around a middle plane (2D: line) with unit normal ``n``; cells have size 1 and the threshold
is 1/2.  The fraction of a cell of any dimension depends only on the signed distance ``u`` of its
centre from the middle plane: its fictitious cell is a unit cube whose points have the distances
``u + P``, where ``P`` is ``n . x`` for points ``x`` of a cube around the origin.  The gap fills at
most half of the cell exactly if ``L`` is at most twice the median of ``|u + P|``, which is the
cell's *critical width*.

With exact volumes it is the median of a continuous distribution (of a sum of uniform variables);
with ``s`` samples along each side it is the upper median of ``s**dim`` numbers.  A cell is kept if
``L <= critical width``, including ties, as in the paper.
"""

from __future__ import annotations

import itertools

import numpy as np

from tusqh.grid import FloatArray


def sample_distances(normal: FloatArray, samples: int) -> FloatArray:
    """Return the signed distances of a cell's samples from the plane through its centre.

    Parameters
    ----------
    normal
        Unit normal, shape (dim,).
    samples
        Samples along each side; 0 for exact volumes, which need no samples.

    Examples
    --------
    >>> import numpy as np
    >>> sample_distances(np.array([1.0, 0.0]), 2).tolist()
    [-0.25, -0.25, 0.25, 0.25]
    """
    along = (np.arange(samples) + 0.5) / max(samples, 1) - 0.5
    points = np.array(list(itertools.product(along, repeat=len(normal)))).reshape(-1, len(normal))
    return points @ np.asarray(normal, dtype=np.float64)
