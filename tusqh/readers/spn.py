"""Read the labels in an SPN file, the text in which Sculpt reads a grid of materials.

The file is a column of whole numbers, one for each voxel, and states neither their shape nor their
order; both are options, as in Sculpt.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tusqh.errors import GeometryError
from tusqh.geometry.remark import Remark
from tusqh.readers.labels import to_text
from tusqh.readers.reading import Reading
from tusqh.readers.voxels import image_in_file
from tusqh.settings.voxels import Voxels

#: Bytes of a file of labels.
_OF_LABELS = b"0123456789 \t\r\n\f\v"
#: Highest label; longer numbers are damaged, and NumPy clips those that do not fit in 64 bits.
_HIGHEST = 2**31 - 1


def read(path: Path, *, meaning: Voxels) -> Reading:
    """Read the labels.

    Parameters
    ----------
    path
        The file.
    meaning
        The number of voxels along every axis, their order, and what they mean.

    Returns
    -------
    Reading
        The geometry.

    Raises
    ------
    GeometryError
        The number of voxels is not given or is another one, or a label is not a whole number from
        0 on.

    References
    ----------
    The options ``input_spn`` and ``spn_xyz_order`` in the manual of Sculpt (Cubit 16.14).
    """
    labels = _labels(path.read_bytes().removeprefix(b"\xef\xbb\xbf"), path)
    if meaning.voxels is None:
        raise GeometryError(
            f"{len(labels):,} labels, without the number of voxels along each axis",
            where=str(path),
            expected="the option `voxels`: the numbers along x, y and z",
            remedy=f"give for instance --voxels {_guess(len(labels))}, or "
            "`image: {voxels: [...]}` in the configuration",
        )
    if math.prod(meaning.voxels) != len(labels):
        shape = " x ".join(map(str, meaning.voxels))
        raise GeometryError(
            f"{len(labels):,} labels for {shape} = {math.prod(meaning.voxels):,} voxels",
            where=str(path),
            expected="a label for each voxel",
            remedy="correct `voxels`, or export the file again if it is cut off",
        )
    axes = ["xyz".index(letter) for letter in meaning.voxel_order or "xyz"]
    in_file = labels.reshape([meaning.voxels[axis] for axis in axes])
    voxels = np.ascontiguousarray(in_file.transpose(np.argsort(axes)))
    if meaning.labels is not None or meaning.empty is not None or meaning.full is not None:
        return image_in_file(path, voxels, meaning=meaning, is_named=True)
    material = tuple(int(k) for k in np.unique(labels) if k)
    said = Remark("changed", f"labels into material: {to_text(material)}", len(material))
    meaning = replace(meaning, labels=material)
    return image_in_file(path, voxels, meaning=meaning, is_named=True, remarks=[said])


def _labels(content: bytes, path: Path) -> NDArray[np.integer]:
    """Return all labels of a file, in the smallest type that holds them."""
    if content.translate(None, _OF_LABELS):
        word = next(w for w in content.split() if w.translate(None, _OF_LABELS))
        shown = word.decode(errors="replace")[:40]
        raise GeometryError(
            f"labels include {shown!r}",
            where=str(path),
            expected="whole numbers from 0 on, one for each voxel",
            remedy="export the labels alone, as whole numbers; interpolated labels mean nothing",
        )
    if not content.strip():
        raise GeometryError(
            "the file has no label",
            where=str(path),
            expected="a whole number for each voxel",
            remedy="export or copy it again",
        )
    values = np.fromstring(content.strip(), dtype=np.int64, sep=" ")
    highest = int(values.max(initial=0))
    if highest > _HIGHEST:
        raise GeometryError(
            f"the label {highest:,}",
            where=str(path),
            expected=f"labels up to {_HIGHEST:,}",
            remedy="copy or export the file again; it is damaged",
        )
    return values.astype(np.min_scalar_type(highest))


def _guess(n: int) -> str:
    """Return the shape of a cube of n voxels as an example, or another shape."""
    side = round(n ** (1 / 3))
    return ",".join([str(side)] * 3) if side**3 == n else f"{n},1,1"
