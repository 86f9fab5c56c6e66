"""Read and write the fractions of several materials: an npz file of exact integers."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tusqh.contacts.material_fractions import MaterialFractions
from tusqh.grid import BackgroundGrid
from tusqh.sampling.io import reading_arrays, write_arrays


def save_materials(path: Path, fractions: MaterialFractions) -> None:
    """Write fractions; the file is never incomplete.

    Parameters
    ----------
    path
        The npz file.
    fractions
        What to write.
    """
    arrays: dict[str, NDArray[Any]] = {
        "start": fractions.start,
        "material": fractions.material,
        "multiple": fractions.multiple,
        "names": np.array(json.dumps(fractions.names)),
        "grid": np.array(json.dumps(fractions.grid.to_dict())),
    }
    write_arrays(path, arrays)


def load_materials(path: Path) -> MaterialFractions:
    """Return the fractions in a file that `save_materials` wrote, bit for bit.

    Parameters
    ----------
    path
        The npz file.

    Raises
    ------
    SamplingError
        The file is missing, or `save_materials` did not write it.
    """
    what = "fractions of several materials"
    with reading_arrays(path, what, "mesh the materials again") as content:
        return MaterialFractions(
            grid=BackgroundGrid.from_dict(json.loads(str(content["grid"]))),
            names=tuple(json.loads(str(content["names"]))),
            start=content["start"].astype(np.int64),
            material=content["material"].astype(np.int32),
            multiple=content["multiple"].astype(np.int32),
        )
