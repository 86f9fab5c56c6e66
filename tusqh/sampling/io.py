"""Read and write fractions: an npz file of exact integers and the grid they belong to."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib.npyio import NpzFile
from numpy.typing import NDArray

from tusqh.atomic import replacing
from tusqh.errors import SamplingError
from tusqh.grid import BackgroundGrid
from tusqh.sampling.fractions import VolumeFractions
from tusqh.sampling.placement import Placement

#: Size in bytes from which zip needs its larger headers, less room for the array's own header.
_LARGE = 2**31 - 2**16


def save_fractions(path: Path, fractions: VolumeFractions) -> None:
    """Write fractions as integer multiples of `RESOLUTION`; the file is never incomplete.

    Parameters
    ----------
    path
        The npz file.
    fractions
        What to write.
    """
    arrays: dict[str, NDArray[Any]] = {
        "multiples": np.asarray(fractions.multiples, dtype=np.int32),
        "samples": np.array(fractions.samples, dtype=np.int64),
        "grid": np.array(json.dumps(fractions.grid.to_dict())),
    }
    if fractions.placement is not None:
        arrays["placement"] = np.array(json.dumps(fractions.placement.to_dict()))
    write_arrays(path, arrays)


def write_arrays(path: Path, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Write arrays as an npz file, whose bytes depend on them alone.

    Parameters
    ----------
    path
        The npz file.
    arrays
        The arrays by name.
    """
    with replacing(path) as temporary, zipfile.ZipFile(temporary, "w") as archive:
        for name, array in arrays.items():
            # Like `numpy.savez_compressed`, whose headers, however, depend on the Python version.
            entry = zipfile.ZipInfo(f"{name}.npy")
            entry.compress_type = zipfile.ZIP_DEFLATED
            is_large = array.nbytes >= _LARGE
            with archive.open(entry, "w", force_zip64=is_large) as stream:
                np.lib.format.write_array(stream, array, allow_pickle=False)


def load_fractions(path: Path) -> VolumeFractions:
    """Return the fractions in a file that `save_fractions` wrote, bit for bit.

    Parameters
    ----------
    path
        The npz file.

    Raises
    ------
    SamplingError
        The file is missing, or `save_fractions` did not write it.
    """
    with reading_arrays(path, "volume fractions", "run the sample step again") as content:
        placement = None
        if "placement" in content:
            placement = Placement.from_dict(json.loads(str(content["placement"])))
        return VolumeFractions(
            grid=BackgroundGrid.from_dict(json.loads(str(content["grid"]))),
            samples=int(content["samples"]),
            multiples=content["multiples"].astype(np.int32, copy=False),
            placement=placement,
        )


@contextmanager
def reading_arrays(path: Path, what: str, remedy: str) -> Iterator[NpzFile]:
    """Open an npz file, and turn every failure to read it into an error that names it.

    Parameters
    ----------
    path
        The npz file.
    what
        What it should hold, for the message.
    remedy
        How to make the file again.

    Raises
    ------
    SamplingError
        The file is missing, or its arrays are not those that are read.
    """
    try:
        with np.load(path) as content:
            yield content
    except (OSError, KeyError, TypeError, ValueError, zipfile.BadZipFile) as reason:
        raise SamplingError(
            f"cannot be read as {what}: {reason}",
            where=str(path),
            expected=f"{what} that tusqh wrote",
            remedy=remedy,
        ) from reason
