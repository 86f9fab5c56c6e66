"""The folder of finished slabs, from which an interrupted run goes on."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tusqh.atomic import replacing
from tusqh.errors import OutputError

#: Digits of a digest in the name of a file.
_DIGITS = 16


@dataclass(frozen=True)
class WorkFolder:
    """A folder of finished slabs.

    The name of a file has the digest of everything on which the slab depends, and a file appears
    complete or not at all.  So a file that is there need not be made again.

    Parameters
    ----------
    path
        The folder.
    """

    path: Path

    def name(self, kind: str, digest: str, number: int) -> Path:
        """Return the path of a slab.

        Parameters
        ----------
        kind
            What it holds, such as ``fractions``.
        digest
            Digest of everything on which it depends.
        number
            Number of the slab.
        """
        return self.path / f"{kind}-{digest[:_DIGITS]}-{number:04d}.npz"

    def keep(self, digests: Sequence[str]) -> None:
        """Remove everything but finished slabs with given digests.

        Parameters
        ----------
        digests
            The digests.
        """
        kept = {digest[:_DIGITS] for digest in digests}
        for file in self.path.glob("*") if self.path.is_dir() else ():
            if file.name.count("-") != 2 or file.name.split("-")[1] not in kept:
                file.unlink()

    def require_own(self) -> None:
        """Raise an error if the folder has files that are not those of slabs.

        Raises
        ------
        OutputError
            There are other files, which the end of the run would remove.
        """
        others = [
            file.name
            for file in sorted(self.path.glob("*"))
            if not file.name.lstrip(".").startswith(("fractions-", "elements-", "sign-"))
        ]
        if others:
            raise OutputError(
                f"holds {others[0]}, which is not a slab",
                where=str(self.path),
                expected="a folder for slabs alone, which is removed in the end",
                remedy="move that file, or choose another name for the mesh",
            )

    def remove(self) -> None:
        """Remove the folder with all slabs."""
        shutil.rmtree(self.path, ignore_errors=True)


def write_plain(path: Path, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Write arrays without compression; the file appears complete or not at all.

    Parameters
    ----------
    path
        The npz file.
    arrays
        The arrays by name.
    """
    with replacing(path) as temporary:
        np.savez(temporary, **dict(arrays))  # type: ignore[arg-type]
