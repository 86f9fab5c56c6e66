"""Measure the defects of a geometry without repairing them."""

from __future__ import annotations

import pandas as pd

from tusqh.geometry.defect import tabulate_defects
from tusqh.geometry.image import Image
from tusqh.geometry.kinds import Geometry
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup_defects import SOUP_DEFECTS
from tusqh.geometry.soup_facts import SoupFacts
from tusqh.geometry.voxel_counts import PIXEL_COUNTS, VOXEL_COUNTS, VoxelFacts


def describe_defects(geometry: Geometry) -> pd.DataFrame:
    """Return one row for each kind of defect; each kind of geometry always has the same rows.

    Dirty geometry is input, not an error; every kind of defect is reported, found or not.

    Parameters
    ----------
    geometry
        An outline, a soup, or an image, whose voxels are counted.

    Returns
    -------
    pandas.DataFrame
        Columns ``defect``, ``count``, ``measure`` (its meaning is in ``explanation``; NaN where
        the defect is only counted), ``unit`` and ``explanation``.

    Notes
    -----
    Two points are the same if their coordinates are equal in every bit.  The order of segments or
    triangles does not matter.  Reversing all segments swaps ``counter_clockwise_chains`` with
    ``clockwise_chains`` and changes the sign of ``signed_area``, and nothing else.
    pymeshlab counts the self-intersecting triangles; the count is -1 if it is not installed.

    Examples
    --------
    >>> import numpy as np
    >>> bow_tie = np.array([[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0], [0.0, 0.0]])
    >>> table = describe_defects(Outline.from_chains([bow_tie])).set_index("defect")
    >>> int(table["count"]["crossings"]), int(table["count"]["open_ends"])
    (1, 0)
    """
    if isinstance(geometry, Image):
        rows = PIXEL_COUNTS if geometry.dim == 2 else VOXEL_COUNTS
        return tabulate_defects(rows, VoxelFacts(geometry), unit=geometry.unit)
    if isinstance(geometry, Outline):
        from tusqh.geometry.outline_defects import OUTLINE_DEFECTS
        from tusqh.geometry.outline_facts import OutlineFacts

        return tabulate_defects(OUTLINE_DEFECTS, OutlineFacts(geometry), unit=geometry.unit)
    return tabulate_defects(SOUP_DEFECTS, SoupFacts(geometry), unit=geometry.unit)
