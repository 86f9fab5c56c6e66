"""Clusters of adjacent pinches, and one decision for each cluster.

"All adjacent pinches must be resolved in the same way" (paper: Anti-aliasing).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from tusqh.antialias.pinches import find_pinch_edges, find_pinches
from tusqh.grid import BoolArray, FloatArray, IntArray, doubled
from tusqh.grid.neighbourhoods import neighbours_along
from tusqh.settings.policy import MixedPinches

#: Values of `Decisions.at_vertex`.
SEPARATE, NONE, CONNECT = -1, 0, 1


@dataclass(frozen=True)
class Decisions:
    """The decision at every pinch.

    Parameters
    ----------
    at_vertex
        `SEPARATE`, `NONE` or `CONNECT` for every grid vertex, shape ``n + 1``, int8.
    n_clusters
        Number of clusters of adjacent pinches.
    clusters_overruled
        Clusters whose pinches disagree, so that at least one pinch is overruled.
    pinches_overruled
        Pinches whose vote differs from the decision of their cluster.
    """

    at_vertex: np.ndarray[tuple[int, ...], np.dtype[np.int8]]
    n_clusters: int
    clusters_overruled: int
    pinches_overruled: int

    @property
    def n_pinches(self) -> int:
        """Number of pinch vertices."""
        return int(np.count_nonzero(self.at_vertex))


def label_clusters(is_pinch: BoolArray) -> tuple[IntArray, int]:
    """Return the cluster of every pinch vertex and the number of clusters.

    Two pinches are adjacent if they are ends of one grid edge in 2D, or corners of one grid
    face in 3D.

    Parameters
    ----------
    is_pinch
        Pinch vertices, shape ``n + 1``.

    Returns
    -------
    labels
        Cluster of every pinch, from 1; 0 elsewhere, shape ``n + 1``.
    n_clusters
        Number of clusters.

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
    kept: BoolArray,
    values: FloatArray,
    *,
    threshold: float,
    mixed_pinches: MixedPinches = "separate",
) -> Decisions:
    """Return the decision of every cluster: connect interior pinches, separate exterior ones.

    A pinch vertex, and in 3D a pinch edge, votes to connect if its sub-cell volume fraction is at
    least the threshold.  A unanimous cluster follows its votes; mixed clusters follow
    `mixed_pinches`; with ``"majority"``, a tie separates.

    Parameters
    ----------
    kept
        Kept cells, shape n.
    values
        Volume fractions on the doubled grid, shape ``2 n + 1``, dimensionless.
    threshold
        Volume-fraction threshold, dimensionless.
    mixed_pinches
        What to do with clusters whose pinches disagree.
    """
    is_interior = values >= threshold
    edges = []
    for axis in range(3) if kept.ndim == 3 else ():
        votes = is_interior[doubled.edges(3, axis)]
        edges.append((find_pinch_edges(kept, axis), votes))
    vertices = is_interior[doubled.vertices(kept.ndim)]
    return decide_by_vote(find_pinches(kept), vertices, edges, mixed_pinches=mixed_pinches)


def decide_by_vote(
    is_pinch: BoolArray,
    votes_connect: BoolArray,
    edges: Sequence[tuple[BoolArray, BoolArray]] = (),
    *,
    mixed_pinches: MixedPinches = "separate",
) -> Decisions:
    """Return the decision of every cluster from the votes of its pinches.

    Parameters
    ----------
    is_pinch, votes_connect
        Pinch vertices and votes to connect, shape ``n + 1`` each.
    edges
        In 3D, the pinch edges along every axis and their votes.
    mixed_pinches
        What to do with clusters whose pinches disagree.

    Examples
    --------
    >>> import numpy as np
    >>> pinches = np.array([True, True, False, True])
    >>> votes = np.array([True, False, False, True])
    >>> decided = decide_by_vote(pinches, votes, mixed_pinches="separate")
    >>> decided.at_vertex.tolist(), decided.n_clusters, decided.clusters_overruled
    ([-1, -1, 0, 1], 2, 1)
    """
    labels, n_clusters = label_clusters(is_pinch)
    cluster, ayes = [labels[is_pinch]], [votes_connect[is_pinch]]
    for axis, (is_pinch_edge, votes) in enumerate(edges):
        # Both ends of a pinch edge are pinches of one cluster.
        at_lower_end, _ = neighbours_along(labels, axis)
        cluster.append(at_lower_end[is_pinch_edge])
        ayes.append(votes[is_pinch_edge])
    voters, vote = np.concatenate(cluster), np.concatenate(ayes)
    size = np.bincount(voters, minlength=n_clusters + 1)
    n_ayes = np.bincount(voters[vote], minlength=n_clusters + 1)
    unanimous = (n_ayes == 0) | (n_ayes == size)
    if mixed_pinches == "majority":
        connects = 2 * n_ayes > size
    else:
        connects = np.where(unanimous, n_ayes == size, mixed_pinches == "connect")
    at_vertex = np.where(connects[labels], CONNECT, SEPARATE).astype(np.int8)
    at_vertex[~is_pinch] = NONE
    return Decisions(
        at_vertex=at_vertex,
        n_clusters=n_clusters,
        clusters_overruled=int(np.count_nonzero(~unanimous)),
        pinches_overruled=int(np.count_nonzero(vote != connects[voters])),
    )
