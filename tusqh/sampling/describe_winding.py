"""The range of the winding number, as rows of the table of defects."""

from __future__ import annotations

import numpy as np
import pandas as pd

from tusqh.geometry.kinds import Surface
from tusqh.grid import BackgroundGrid
from tusqh.sampling.closing import close
from tusqh.sampling.field import TOLERANCE, CrossingField, wind_on_lattice
from tusqh.sampling.lattice import Lattice


def describe_winding(geometry: Surface, *, n: int = 32) -> pd.DataFrame:
    """Return the range of the winding number on a lattice, and the size of the cap it needs.

    `count` is the number of samples below 0 (parts are inside out) or above 1 (parts overlap).

    Parameters
    ----------
    geometry
        The geometry.
    n
        Samples along the longest side of the bounding box.

    Examples
    --------
    >>> from tusqh.geometry.soup import Soup
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> faces = np.array([[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 1]])
    >>> table = describe_winding(Soup(points, faces, np.zeros(4, dtype=np.int64)))
    >>> table["measure"].tolist()
    [0.0, 1.0, 0.0]
    """
    low, high = geometry.bounding_box()
    size = max(b - a for a, b in zip(low, high, strict=True)) / n
    shape = tuple(max(1, round((b - a) / size)) for a, b in zip(low, high, strict=True))
    grid = BackgroundGrid(shape=shape, cell_size=size, origin=low)
    # Two samples along a cell are the fewest that half-blocks allow; every second one is enough.
    lattice = Lattice.over_grid(grid, 2)
    cycle, cap = close(geometry)
    winding = wind_on_lattice(CrossingField(cycle, cap, TOLERANCE), lattice)
    winding = np.round(winding[::2, :: 1 if grid.dim == 2 else 2, ::2], 9)
    what = f"winding number over {grid.label} samples of the bounding box; samples"
    kind = "segments" if grid.dim == 2 else "triangles"
    rows = [
        ("winding_number_min", int((winding < 0).sum()), winding.min(), f"least {what} below 0"),
        ("winding_number_max", int((winding > 1).sum()), winding.max(), f"greatest {what} above 1"),
        (
            "cap",
            len(cap),
            float(np.abs(cap.multiplicity).max(initial=0)),
            f"{kind} that close the boundary; the greatest multiplicity of one",
        ),
    ]
    table = pd.DataFrame(rows, columns=["defect", "count", "measure", "explanation"])
    table.insert(3, "unit", "-")
    return table
