"""The layers of void around a grid in which contacts are decided."""

from __future__ import annotations

import numpy as np

from tusqh.contacts.decided import Labels
from tusqh.contacts.spatial_votes import LAYERS

#: Layers of void around the cells of a decision, by dimension.
LAYERS_OF = {2: 1, 3: LAYERS}


def surround(labels: Labels, void: int) -> Labels:
    """Return labels with the layers of void that decisions need.

    Parameters
    ----------
    labels
        Material of every cell, shape n.
    void
        Label of the void.
    """
    return np.pad(labels, LAYERS_OF[labels.ndim], constant_values=void)


def inner_cells(dim: int) -> tuple[slice, ...]:
    """Return the slices that leave out the layers of void of a decision.

    Parameters
    ----------
    dim
        Dimension of the grid.

    Returns
    -------
    slices
        One for each axis.
    """
    return (slice(LAYERS_OF[dim], -LAYERS_OF[dim]),) * dim
