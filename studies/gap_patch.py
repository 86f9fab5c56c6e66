r"""Measure the widths at which a gap opens and closes, on a patch of cells along it.

As a gap grows wider, it drops the cells of the doubled grid one by one at their critical widths
(`studies.gap_kernels.critical_width`), so the gap's width defines a filtration.  Two numbers
describe the outcome for a patch, an orientation and an offset:

* up to the *closing width*, the smallest critical width of all cells, no cell is dropped: the gap
  is **closed**, which means joined everywhere and without a void;
* beyond the *opening width*, the largest width at which a path of kept cells joins the two
  half-spaces (a bottleneck: the merge of two components), it is **open**;
* between them it is **mixed**: joined in some places, with voids.

The rule determines which cells a path can use.  All rules use the same graph, in which cells of all
dimensions are joined if one is a face of the other; the rules differ only in the critical widths of
the lower dimensions::

    touching   the largest of the adjacent cells: cells are closed sets, pinches join
    faces      the smallest of the adjacent cells: only whole shared faces join
    filtration the paper's complex: a face is kept if both its cells are; edges (3D) and vertices
               have their own width, clamped to the range of the adjacent cells
    sub-cells  all have their own width, as in the theorem's proof

In the plane our meshes agree with the filtration (`studies.gap_meshes`), and in space wherever no
vote is overruled (`studies.contacts`).
"""

from __future__ import annotations

import numpy as np

from studies.gap_kernels import measure_patches
from tusqh.grid import FloatArray


def measure_widths(
    normals: FloatArray, offsets: FloatArray, distances: FloatArray, *, length: int
) -> tuple[FloatArray, FloatArray]:
    """Return the closing and the opening widths of patches, in cell sizes.

    Parameters
    ----------
    normals
        Unit normals of the gap, shape (m, dim), components from large to small, none negative.
    offsets
        Shifts of the grid along its first axis, in cell sizes, shape (k,); 0 centres a cell on
        the middle of the gap.
    distances
        Distances of a cell's samples for every normal, shape (m, s**dim), see
        `studies.gap.sample_distances`; shape (m, 0) for exact volumes.
    length
        Number of cells along the gap (in 3D along both of its directions).

    Returns
    -------
    closing, opening
        Shape (m, k, 4), where the last axis has the order of `studies.gap_kernels.RULES`.

    Examples
    --------
    A gap along the axes, offset by half a cell, is joined through whole cells up to a width of one
    cell; with sub-cells it is open as soon as it is wider than half a cell.

    >>> import numpy as np
    >>> normal, exact = np.array([[1.0, 0.0]]), np.empty((1, 0))
    >>> closing, opening = measure_widths(normal, np.array([0.5]), exact, length=4)
    >>> opening.round(6).tolist()
    [[[1.0, 1.0, 1.0, 0.5]]]
    >>> closing.round(6).tolist()
    [[[1.0, 1.0, 1.0, 0.5]]]
    """
    widths = measure_patches(
        np.ascontiguousarray(normals, dtype=np.float64),
        np.asarray(offsets, dtype=np.float64),
        np.ascontiguousarray(distances, dtype=np.float64),
        length,
    )
    return widths[..., 0], widths[..., 1]
