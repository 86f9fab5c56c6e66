"""Clusters of adjacent pinches and the one decision that each of them gets.

"All adjacent pinches must be resolved in the same way" (paper: Anti-aliasing).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from tusqh.antialias.policy import MixedPinches
from tusqh.grid import BoolArray, FloatArray, IntArray

#: Values of `Decisions.at_vertex`.
SEPARATE, NONE, CONNECT = -1, 0, 1


@dataclass(frozen=True)
class Decisions:
    """What happens at every pinch.

    Parameters
    ----------
    at_vertex
        `SEPARATE`, `NONE` or `CONNECT` for every grid vertex, shape ``n + 1``, int8.
    n_clusters
        Number of clusters of adjacent pinches.
    n_overruled_clusters
        Clusters in which at least one pinch voted otherwise.
    n_overruled_pinches
        Pinches that voted otherwise than their cluster was decided.
    """

    at_vertex: np.ndarray[tuple[int, ...], np.dtype[np.int8]]
    n_clusters: int
    n_overruled_clusters: int
    n_overruled_pinches: int

    @property
    def n_pinches(self) -> int:
        """Number of pinch vertices."""
        return int(np.count_nonzero(self.at_vertex))


def label_clusters(is_pinch: BoolArray) -> tuple[IntArray, int]:
    """Return the cluster of every pinch vertex (from 1; 0 elsewhere) and how many there are.

    Two pinches are adjacent when they are ends of one grid edge in 2D, or corners of one grid
    face in 3D.

    Examples
    --------
    >>> import numpy as np
    >>> label_clusters(np.array([[1, 1, 0], [0, 0, 1]], dtype=bool))[0].tolist()
    [[1, 1, 0], [0, 0, 2]]
    """
    structure = ndimage.generate_binary_structure(is_pinch.ndim, is_pinch.ndim - 1)
    labels, n_clusters = ndimage.label(is_pinch, structure=structure)
    return labels.astype(np.int64), int(n_clusters)


def decide_by_fraction(
    is_pinch: BoolArray,
    vertex_fraction: FloatArray,
    *,
    threshold: float,
    mixed_pinches: MixedPinches = "separate",
) -> Decisions:
    """Return the decision of every cluster: connect interior pinches, separate exterior ones.

    A pinch votes to connect when its sub-cell volume fraction is at least the threshold.  A
    cluster that agrees follows its vote; a mixed one follows `mixed_pinches`, where an even split
    of ``"majority"`` separates.

    Parameters
    ----------
    is_pinch
        Pinch vertices, shape ``n + 1``.
    vertex_fraction
        Sub-cell volume fractions of the grid vertices, shape ``n + 1``, dimensionless.
    threshold
        Volume-fraction threshold, dimensionless.
    mixed_pinches
        What to do with clusters whose pinches disagree.
    """
    return decide_by_vote(is_pinch, vertex_fraction >= threshold, mixed_pinches=mixed_pinches)


def decide_by_vote(
    is_pinch: BoolArray, votes_connect: BoolArray, *, mixed_pinches: MixedPinches = "separate"
) -> Decisions:
    """Return the decision of every cluster, given each pinch's vote.

    Examples
    --------
    >>> import numpy as np
    >>> pinches = np.array([True, True, False, True])
    >>> votes = np.array([True, False, False, True])
    >>> decided = decide_by_vote(pinches, votes, mixed_pinches="separate")
    >>> decided.at_vertex.tolist(), decided.n_clusters, decided.n_overruled_clusters
    ([-1, -1, 0, 1], 2, 1)
    """
    labels, n_clusters = label_clusters(is_pinch)
    size = np.bincount(labels.ravel(), minlength=n_clusters + 1)
    ayes = np.bincount(labels[votes_connect & is_pinch], minlength=n_clusters + 1)
    unanimous = (ayes == 0) | (ayes == size)
    if mixed_pinches == "majority":
        connects = 2 * ayes > size
    else:
        connects = np.where(unanimous, ayes == size, mixed_pinches == "connect")
    unanimous[0] = True
    at_vertex = np.where(connects[labels], CONNECT, SEPARATE).astype(np.int8)
    at_vertex[~is_pinch] = NONE
    return Decisions(
        at_vertex=at_vertex,
        n_clusters=n_clusters,
        n_overruled_clusters=int(np.count_nonzero(~unanimous)),
        n_overruled_pinches=int(np.count_nonzero(is_pinch & (votes_connect != (at_vertex > 0)))),
    )
