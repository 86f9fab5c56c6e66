"""Read the triangles of an STL file.

STL has no connectivity, so every triangle has corners of its own; only equal coordinates tell
which triangles meet, see `tusqh.geometry.soup.Soup.matched`.
"""

from __future__ import annotations

import struct
from pathlib import Path

import trimesh

from tusqh.errors import GeometryError
from tusqh.geometry.soup import Soup
from tusqh.readers.reading import Reading
from tusqh.readers.surfaces import surfaces_of_scene


def read(path: Path) -> Reading:
    """Read every solid of the file as a part of the soup.

    Parameters
    ----------
    path
        The file, binary or text.

    Returns
    -------
    Reading
        The geometry.

    Raises
    ------
    GeometryError
        The file is incomplete, or the soup is empty, without extent or not finite.
    """
    _check_size(path)
    scene = trimesh.load_scene(path, process=False)
    return Reading(Soup.from_parts(surfaces_of_scene(scene), name=path.name))


def _check_size(path: Path) -> None:
    """Raise when a binary STL is shorter or longer than its own count says."""
    size = path.stat().st_size
    with path.open("rb") as stream:
        head = stream.read(84)
    if head.lstrip()[:5].lower() == b"solid" and b"\0" not in head:
        tail = path.read_bytes()[-200:].lower()
        if b"endsolid" not in tail:
            raise _damaged(path, "the text ends before `endsolid`")
        return
    if len(head) < 84:
        raise _damaged(path, f"the file has {size} bytes, too few for an STL header")
    (n_triangles,) = struct.unpack("<I", head[80:84])
    if size < 84 + 50 * n_triangles:
        raise _damaged(
            path,
            f"the header promises {n_triangles} triangles, the file holds {(size - 84) // 50}",
        )


def _damaged(path: Path, found: str) -> GeometryError:
    return GeometryError(
        found,
        where=str(path),
        expected="a complete STL file",
        remedy="copy or export the file again; it is cut off or damaged",
    )
