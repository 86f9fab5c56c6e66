"""Compute digests of files, reading each file once."""

from __future__ import annotations

from tusqh.errors import GeometryError
from tusqh.geometry.packaged import locate
from tusqh.hashing import hash_file

_SHOWN = 12


class Digests:
    """SHA-256 digests of the files in the current folder.

    Each file is read once, when its digest is first needed.  An instance belongs to one
    verification, so make a new one after files have changed.
    """

    def __init__(self) -> None:
        self._known: dict[str, str | None] = {}

    def of(self, name: str) -> str | None:
        """Return the SHA-256 of a file, None if the file does not exist.

        Parameters
        ----------
        name
            A path, or the name of a file inside an installed package.
        """
        if name not in self._known:
            try:
                self._known[name] = hash_file(locate(name))
            except (OSError, GeometryError):
                self._known[name] = None
        return self._known[name]


def shorten(digest: str) -> str:
    """Return the first digits of a digest, enough to recognise it.

    Parameters
    ----------
    digest
        A SHA-256 as hexadecimal digits.
    """
    return f"SHA-256 {digest[:_SHOWN]}"
