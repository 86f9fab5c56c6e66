"""Find small components to remove and small holes to fill, after the pinch decisions.

Each change is recorded as a row of a table.  Removing a component and filling a hole (in 3D a
void) are the same operation on the cells and on their complement (paper: Anti-aliasing, the end of
the paragraph on archipelagos).  Neither creates a new pinch: around a vertex that is not a pinch
all kept cells are joined, and so are all empty cells, so they are kept or removed together.
"""

from __future__ import annotations

import numpy as np
import pandas as pd

from tusqh.contacts.decided import Contacts, Labels
from tusqh.contacts.one_material import MATERIAL
from tusqh.contacts.predict import find_components
from tusqh.contacts.surround import inner_cells
from tusqh.grid import BoolArray, FloatArray, IndexArray, IntArray, doubled
from tusqh.sampling.doubled_grid import RESOLUTION
from tusqh.sampling.fractions import VolumeFractions, to_level
from tusqh.settings.policy import Criteria

#: Names of the features.
COMPONENT, HOLE, VOID = "component", "hole", "void"

#: Columns of the table of removed components and filled holes, before the coordinates.
FEATURE_COLUMNS = [
    "feature",
    "cells",
    "volume",
    "persistence",
    "smallest_fraction",
    "largest_fraction",
    "interior_sub_cells",
]


def label_kept(labels: Labels, contacts: Contacts) -> IntArray:
    """Return the component of every kept cell, numbered from 1; 0 elsewhere, shape n.

    Parameters
    ----------
    labels
        Labels of kept and empty cells, see `tusqh.contacts.one_material_contacts.label_cells`.
    contacts
        The decisions at their contacts.
    """
    component = find_components(labels, contacts)
    return _number(component, labels == MATERIAL)


def label_holes(labels: Labels, contacts: Contacts) -> IntArray:
    """Return the hole, in 3D the void, of every empty cell, from 1; 0 elsewhere, shape n.

    Parameters
    ----------
    labels, contacts
        See `label_kept`.
    """
    component = find_components(labels, contacts)
    return _number(component, (labels != MATERIAL) & (component != component.flat[0]))


def _number(component: IndexArray, chosen: BoolArray) -> IntArray:
    """Return the components of chosen cells, numbered from 1 and without the layers of void."""
    numbers = np.zeros(component.shape, dtype=np.int64)
    numbers[chosen] = 1 + np.unique(component[chosen], return_inverse=True)[1]
    return numbers[inner_cells(component.ndim)]


def find_small_features(
    labels: IntArray,
    criteria: Criteria,
    fractions: VolumeFractions,
    persistence: FloatArray,
    *,
    threshold: float,
    feature: str,
) -> tuple[BoolArray, pd.DataFrame]:
    """Return the cells of the features that do not meet the criteria, and a row for each.

    Parameters
    ----------
    labels
        Feature to which every cell belongs, numbered from 1, possibly with gaps; 0 elsewhere,
        shape n.
    criteria
        The criteria that a feature must meet to stay.
    fractions
        Volume fractions, for the record.
    persistence
        Persistence of the class that each cell creates (or, for holes, destroys), shape n; the
        persistence of a feature is the largest among its cells.
    threshold
        Volume-fraction threshold, for counting interior sub-cells.
    feature
        `COMPONENT`, `HOLE` or `VOID`, for the table.

    Returns
    -------
    is_removed
        The cells of these features, shape n.
    table
        One row per feature found: its kind, cells, volume (model units**dim), persistence,
        smallest and largest cell fraction, the number of interior edges and vertices among its
        cells' sub-cells, and its centre (model units).
    """
    n_cells = np.bincount(labels.ravel())
    grid = fractions.grid
    volume = n_cells * grid.cell_size**grid.dim
    lives = np.zeros(len(n_cells))
    np.maximum.at(lives, labels.ravel(), persistence.ravel())
    is_feature = (n_cells > 0) & (np.arange(len(n_cells)) > 0)
    is_small = (n_cells < criteria.min_cells) | (volume < criteria.min_volume)
    is_small |= lives < criteria.min_persistence
    if criteria.keep is not None:
        numbers = np.flatnonzero(is_feature)
        ranked = numbers[np.lexsort((numbers, -n_cells[numbers], -lives[numbers]))]
        is_small[ranked[criteria.keep :]] = True
    is_small &= is_feature
    found = np.flatnonzero(is_small)
    is_removed = is_small[labels]
    # Only the removed cells are examined, since they are few.
    place = np.nonzero(is_removed)
    own = np.searchsorted(found, labels[place])
    smallest, largest = np.full(len(found), np.inf), np.full(len(found), -np.inf)
    values = fractions.cell_multiples[place] * RESOLUTION
    np.minimum.at(smallest, own, values)
    np.maximum.at(largest, own, values)
    sums = [np.bincount(own, weights=at, minlength=len(found)) for at in place]
    places = grid.to_points(np.stack(sums, axis=1) / n_cells[found][:, None] + 0.5)
    columns = [
        np.full(len(found), feature),
        n_cells[found],
        volume[found],
        lives[found],
        smallest,
        largest,
        _count_interior_sub_cells(np.where(is_removed, labels, 0), fractions, threshold)[found],
    ]
    table = pd.DataFrame(dict(zip(FEATURE_COLUMNS, columns, strict=True)))
    for axis in range(grid.dim):
        table["xyz"[axis]] = places[:, axis]
    return is_removed, table


def _count_interior_sub_cells(
    labels: IntArray, fractions: VolumeFractions, threshold: float
) -> IntArray:
    """Count, for every feature, the sub-cells of its cells with ``F >= threshold``."""
    from scipy import ndimage

    n = int(labels.max(initial=0)) + 1
    if n == 1:
        return np.zeros(1, dtype=np.int64)
    # Only the surroundings of the features are examined, since they are small.
    box = tuple(
        slice(max(2 * int(at.min()), 0), 2 * int(at.max()) + 3) for at in np.nonzero(labels)
    )
    on_doubled = np.zeros(fractions.multiples.shape, dtype=np.int64)
    on_doubled[doubled.cells(labels.ndim)] = labels
    on_doubled = on_doubled[box]
    # A sub-cell between two features counts for the one with the larger label.
    around = ndimage.grey_dilation(on_doubled, size=(3,) * labels.ndim)
    is_interior = (fractions.multiples[box] >= to_level(threshold)) & (around > 0)
    is_interior &= on_doubled == 0
    return np.bincount(around[is_interior], minlength=n).astype(np.int64)
