"""Say what is in an image of voxels: counted, never repaired."""

from __future__ import annotations

import numpy as np
import pandas as pd

from tusqh.geometry.image import Image


def describe_voxels(image: Image) -> pd.DataFrame:
    """Return counts of voxels, with the columns of the table of defects of a surface.

    Examples
    --------
    >>> image = Image(np.array([[[0, 50, 200]]], dtype=np.uint8), empty=0, full=100)
    >>> table = describe_voxels(image)
    >>> table["defect"].tolist(), table["count"].tolist()
    (['voxels', 'material_voxels', 'partial_voxels', 'clipped_voxels'], [3, 2, 1, 1])
    """
    fractions = image.fractions()
    volume = image.voxel_size**3
    low, high = sorted((image.empty, image.full))
    grey = image.voxels.astype(np.float64)
    excess = np.maximum(low - grey, grey - high)
    is_partial = (fractions > 0) & (fractions < 1)
    rows = [
        ("voxels", fractions.size, fractions.size * volume, "all voxels; their volume"),
        (
            "material_voxels",
            int((fractions >= 0.5).sum()),
            float(fractions.sum()) * volume,
            "voxels at least half full; the volume that all fractions add up to",
        ),
        (
            "partial_voxels",
            int(is_partial.sum()),
            float(fractions[is_partial].sum()) * volume,
            "voxels neither empty nor full; the volume that their fractions add up to",
        ),
    ]
    table = pd.DataFrame(rows, columns=["defect", "count", "measure", "explanation"])
    table.insert(3, "unit", "model units^3")
    cut = {
        "defect": "clipped_voxels",
        "count": int((excess > 0).sum()),
        "measure": max(float(excess.max()), 0.0),
        "unit": "grey values",
        "explanation": "voxels beyond `empty` and `full`; by how much at most",
    }
    return pd.concat([table, pd.DataFrame([cut])], ignore_index=True)
