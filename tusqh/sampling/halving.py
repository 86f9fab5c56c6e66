"""Sort triangles into a binary tree of nodes."""

from __future__ import annotations

import numba
import numpy as np


@numba.njit(cache=True)
def halve_triangles(middle, order, leaf):  # type: ignore[no-untyped-def]
    """Sort triangles into the nodes of a tree, halved along the longest axis of their centres.

    Parameters
    ----------
    middle
        Centre of each triangle, shape (m, 3).
    order
        Numbers of the triangles, shape (m,), sorted in place into the order of the leaves.
    leaf
        Most triangles of a leaf.

    Returns
    -------
    first, last : numpy.ndarray
        Range of every node in `order`, shape (n,) each.
    child : numpy.ndarray
        The first of the two children of every node, -1 for a leaf, shape (n,).
    """
    n = len(order)
    first, last, child = [0], [n], [-1]
    node = 0
    while node < len(first):
        a, b = first[node], last[node]
        if b - a > leaf:
            axis, widest = 0, -1.0
            for k in range(3):
                low, high = np.inf, -np.inf
                for i in range(a, b):
                    low = min(low, middle[order[i], k])
                    high = max(high, middle[order[i], k])
                if high - low > widest:
                    axis, widest = k, high - low
            part = order[a:b].copy()
            order[a:b] = part[np.argsort(middle[part, axis], kind="mergesort")]
            half = (a + b) // 2
            child[node] = len(first)
            first += [a, half]
            last += [half, b]
            child += [-1, -1]
        node += 1
    return np.array(first), np.array(last), np.array(child)
