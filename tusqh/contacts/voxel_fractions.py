"""Compute the fractions of several materials from the voxels of an image of labels."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

import numba
import numpy as np
from numpy.typing import NDArray

from tusqh.contacts.material_fractions import FULL, VOID, MaterialFractions
from tusqh.errors import SamplingError
from tusqh.grid import BackgroundGrid

#: Largest number of materials, so that their indices fit in 16 bits in every file format.
MOST_LABELS = 65_535


def fractions_of_labels(
    voxels: NDArray[np.integer],
    *,
    voxels_per_cell: int = 1,
    voxel_size: float = 1.0,
    origin: tuple[float, ...] | None = None,
    names: Mapping[int, str] | None = None,
    void: int | None = None,
) -> MaterialFractions:
    """Return the fractions of the materials in an image of labels.

    A fraction is the share of voxels with a label in a cube, as large as a cell, around a place;
    voxels cut in half count half.  Labels are never interpolated.

    Parameters
    ----------
    voxels
        Labels, shape (nx, ny) or (nx, ny, nz), integers.
    voxels_per_cell
        Voxels along each side of a cell; the part of the last cells beyond the image is void.
    voxel_size
        Edge length of a voxel, in the units of the model.
    origin
        Lowest corner of the image, in the units of the model; 0 by default.
    names
        Names of labels; the other labels are named by their number.
    void
        Label that means no material; None if materials fill the image.

    Raises
    ------
    SamplingError
        Voxels are not integers, there are too many labels, a named label does not occur, two
        labels have one name, or no voxel has a material.

    Examples
    --------
    >>> image = np.array([[1, 1], [1, 2]])
    >>> found = fractions_of_labels(image, voxels_per_cell=2, names={2: "core"})
    >>> found.names, found.volumes()["core"]
    (('1', 'core', 'void'), 1.0)
    """
    _check(voxels, voxels_per_cell)
    values, numbers = np.unique(voxels, return_inverse=True)
    labels = [int(v) for v in values if v != void]
    named = _name(labels, dict(names or {}), is_filled=void is None)
    to_material = np.full(len(values), len(labels), dtype=np.int32)
    to_material[[i for i, v in enumerate(values) if v != void]] = np.arange(len(labels))
    c = voxels_per_cell
    shape = tuple(-(-n // c) for n in voxels.shape)
    image = np.full(tuple(n * c for n in shape), len(labels), dtype=np.int32)
    image[tuple(slice(n) for n in voxels.shape)] = to_material[numbers].reshape(voxels.shape)
    grid = BackgroundGrid(shape, voxel_size * c, origin or (0.0,) * voxels.ndim)
    entries = _tally(image if image.ndim == 3 else image[None], image.ndim, c, len(labels), FULL)
    return MaterialFractions(grid, (*named, VOID), *entries)


def _check(voxels: NDArray[np.integer], voxels_per_cell: int) -> None:
    """Raise a `SamplingError` for voxels that are not labels."""
    if voxels.dtype.kind not in "iu" or voxels.ndim not in (2, 3) or voxels.size == 0:
        raise SamplingError(
            f"voxels of type {voxels.dtype} and shape {voxels.shape}",
            where="image of labels",
            expected="integers along two or three axes",
            remedy="give whole numbers; interpolate no labels when an image is resampled",
        )
    if voxels_per_cell < 1:
        raise SamplingError(
            f"{voxels_per_cell} voxels along a cell",
            where="image of labels",
            expected="at least 1",
            remedy="use 1 for cells that are voxels, 2 or 4 for larger ones",
        )


def _name(labels: list[int], names: dict[int, str], *, is_filled: bool) -> list[str]:
    """Return the name of every label."""
    missing = sorted(set(names) - set(labels))
    named = [names.get(label, str(label)) for label in labels]
    repeated = {name for name, n in Counter(named).items() if n > 1}
    shown = ", ".join(map(str, labels[:20])) + (", ..." if len(labels) > 20 else "")
    rename = "correct the names of the labels"
    problems = [
        (
            not labels,
            "no voxel with a material",
            "at least one label other than the void",
            "check that the image holds labels and that 0 is its void",
        ),
        (
            len(labels) > MOST_LABELS,
            f"{len(labels)} labels",
            f"at most {MOST_LABELS:,}",
            "merge small regions, or mesh the image as grey values if they are not labels",
        ),
        (
            bool(missing),
            f"no voxel with the labels {missing}",
            f"labels of the image: {shown}",
            rename,
        ),
        (
            bool(repeated),
            f"several labels called {sorted(repeated)}",
            "one name for each label",
            rename + "; a label without a name is called by its number",
        ),
        (
            VOID in named,
            f"a material called {VOID}",
            "another name; `void` is what no label has",
            rename,
        ),
    ]
    for is_wrong, found, expected, remedy in problems:
        if is_wrong:
            where = "image of labels" + ("" if is_filled else ", the void left out")
            raise SamplingError(found, where=where, expected=expected, remedy=remedy)
    return named


@numba.njit(cache=True)
def _tally(image, dim, c, void, full):  # type: ignore[no-untyped-def]
    """Return start, material and multiple of every place of the doubled grid."""
    n_x, n_y, n_z = image.shape
    s_x = 2 * (n_x // c) + 1 if dim == 3 else 1
    s_y, s_z = 2 * (n_y // c) + 1, 2 * (n_z // c) + 1
    whole = (2 * c) ** dim
    start = np.zeros(s_x * s_y * s_z + 1, dtype=np.int64)
    material = np.empty(2 * s_x * s_y * s_z, dtype=np.int32)
    multiple = np.empty(2 * s_x * s_y * s_z, dtype=np.int32)
    labels = np.empty((2 * c + 2) ** dim + 1, dtype=np.int32)
    weights = np.empty((2 * c + 2) ** dim + 1, dtype=np.int64)
    n, place = 0, 0
    for i in range(s_x):
        for j in range(s_y):
            for k in range(s_z):
                n_odd = i % 2 * (dim - 2) + j % 2 + k % 2
                m = 0
                if n_odd != dim - 1:
                    x_range = (0, 1) if dim == 2 else ((i - 1) * c // 2, ((i + 1) * c + 1) // 2)
                    for x in range(x_range[0], x_range[1]):
                        w_x = 1
                        if dim == 3:
                            w_x = min(2 * x + 2, (i + 1) * c) - max(2 * x, (i - 1) * c)
                        for y in range((j - 1) * c // 2, ((j + 1) * c + 1) // 2):
                            w_y = min(2 * y + 2, (j + 1) * c) - max(2 * y, (j - 1) * c)
                            for z in range((k - 1) * c // 2, ((k + 1) * c + 1) // 2):
                                w_z = min(2 * z + 2, (k + 1) * c) - max(2 * z, (k - 1) * c)
                                inside = 0 <= x < n_x and 0 <= y < n_y and 0 <= z < n_z
                                label = image[x, y, z] if inside else void
                                at = 0
                                while at < m and labels[at] != label:
                                    at += 1
                                if at == m:
                                    labels[m], weights[m] = label, 0
                                    m += 1
                                weights[at] += w_x * w_y * w_z
                if n + m > len(material):
                    material = np.concatenate((material, np.empty_like(material)))
                    multiple = np.concatenate((multiple, np.empty_like(multiple)))
                for at in range(m):
                    material[n], multiple[n] = (
                        labels[at],
                        (weights[at] * full + whole // 2) // whole,
                    )
                    n += 1
                place += 1
                start[place] = n
    return start, material[:n].copy(), multiple[:n].copy()
