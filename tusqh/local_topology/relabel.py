"""Move the materials of one set of thresholds towards another without a change of topology.

This is `tusqh.local_topology.move` for several materials.  The *seed* has the material of every
cell at thresholds at which every material has the wanted topology, the *base* those at the
thresholds where the geometry is as it should be.  Cells in which the two differ are relabelled
while this is simple for both materials, first those that nearly have the material of the base at
the thresholds of the seed.  Every contact votes at the thresholds of the seed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tusqh.contacts.material_fractions import MaterialFractions
from tusqh.grid import FloatArray, IntArray
from tusqh.local_topology.link import link_in
from tusqh.local_topology.relabel_cells import relabel_simple

Labels = NDArray[np.int32]


def relabel_to_base(
    fractions: MaterialFractions, seed: Labels, base: Labels, thresholds: IntArray
) -> Labels:
    """Return the materials of cells with the topology of a seed, as near to a base as possible.

    Parameters
    ----------
    fractions
        Fractions of all materials.
    seed, base
        Material of every cell, shape n.
    thresholds
        Threshold of every material at the seed, in multiples of 2**-20, shape (m,).

    Returns
    -------
    labels
        Material of every cell, shape n; every cell has that of the seed or that of the base.

    Examples
    --------
    A thin wall w is closed with a smaller threshold, which also takes a cell of b beside it:

    >>> cells = {"a": [[1, 0, 0]] * 3, "w": [[0, 1, 0.4], [0, 0.4, 0], [0, 1, 0]]}
    >>> cells["b"] = [[0, 0, 0.6], [0, 0.6, 1], [0, 0, 1]]
    >>> fractions = MaterialFractions.from_cells({k: np.array(v) for k, v in cells.items()})
    >>> one = np.full(4, 2**20)
    >>> low = np.array([2**20, 2**19, 2**20, 2**20])
    >>> seed, base = fractions.label_cells(low), fractions.label_cells(one)
    >>> base.tolist(), seed.tolist()
    ([[0, 1, 2], [0, 2, 2], [0, 1, 2]], [[0, 1, 1], [0, 1, 2], [0, 1, 2]])
    >>> relabel_to_base(fractions, seed, base, low).tolist()
    [[0, 1, 2], [0, 1, 2], [0, 1, 2]]
    """
    labels = np.pad(seed, 1, constant_values=fractions.void)
    cells = np.argwhere(seed != base)
    cells = cells[np.argsort(-_shares(fractions, cells, seed, base, thresholds), kind="stable")]
    places_shape = tuple(2 * n + 1 for n in seed.shape)
    flat = np.ravel_multi_index(tuple(cells.T + 1), labels.shape)
    places = np.ravel_multi_index(tuple(2 * cells.T + 1), places_shape)
    changed = np.ascontiguousarray(labels, dtype=np.int32).ravel()
    relabel_simple(
        flat.astype(np.int64),
        places.astype(np.int64),
        base[tuple(cells.T)].astype(np.int32),
        changed,
        (fractions.start, fractions.material, fractions.multiple),
        thresholds,
        link_in(labels.shape, places_shape),
    )
    return np.ascontiguousarray(changed.reshape(labels.shape)[(slice(1, -1),) * seed.ndim])


def _shares(
    fractions: MaterialFractions,
    cells: IntArray,
    seed: Labels,
    base: Labels,
    thresholds: IntArray,
) -> FloatArray:
    """Return the score of the base's material as a share of both scores at cells, shape (r,)."""
    shape = tuple(2 * n + 1 for n in seed.shape)
    places = np.ravel_multi_index(tuple(2 * cells.T + 1), shape)
    both = np.stack([seed[tuple(cells.T)], base[tuple(cells.T)]], axis=1)
    multiples = fractions.multiples_at(places.astype(np.int64), both.astype(np.int32))
    # Products of integers below 2**20 are exact.
    own, other = multiples[:, 0] * thresholds[both[:, 1]], multiples[:, 1] * thresholds[both[:, 0]]
    return np.asarray(other / np.maximum(own + other, 1))
