"""The header of a PLY file: its encoding, elements and properties."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from tusqh.readers.polygon_faces import damaged

#: NumPy's name of every PLY type.
TYPES = {
    **{"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"},
    **{"int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4"},
    **{"float": "f4", "double": "f8", "float32": "f4", "float64": "f8"},
}
_ENCODINGS = ("ascii", "binary_little_endian", "binary_big_endian")


@dataclass(frozen=True)
class Property:
    """A property of an element.

    Parameters
    ----------
    name
        Its name.
    type
        NumPy's name for the type of its value, or of the entries of its list.
    count_type
        Type of the number of entries; None if the property is not a list.
    """

    name: str
    type: str
    count_type: str | None = None


@dataclass
class Element:
    """A kind of row in the file: vertices, faces and others.

    Parameters
    ----------
    name
        Its name.
    n_rows
        Number of rows.
    properties
        Properties in each row.
    """

    name: str
    n_rows: int
    properties: list[Property] = field(default_factory=list)

    @property
    def has_lists(self) -> bool:
        """Whether rows differ in length."""
        return any(p.count_type for p in self.properties)


@dataclass(frozen=True)
class Header:
    """The header, which precedes the rows.

    Parameters
    ----------
    encoding
        "ascii", "binary_little_endian" or "binary_big_endian".
    elements
        Elements in the order of the file.
    """

    encoding: str
    elements: list[Element]


def read_header(content: bytes, path: Path) -> tuple[Header, bytes]:
    """Return the header of a PLY file, and the bytes after it.

    Parameters
    ----------
    content
        The bytes of the file.
    path
        The file, for messages.

    Returns
    -------
    header : Header
        The encoding and the elements.
    body : bytes
        The bytes after the line ``end_header``.

    Raises
    ------
    GeometryError
        The header is damaged, or has an unknown encoding or type.
    """
    head, mark, body = content.partition(b"end_header")
    if not mark or not head.startswith(b"ply"):
        raise damaged(path, "the header is incomplete", expected="`ply` to `end_header`")
    body = body.lstrip(b" \t")
    body = body.removeprefix(b"\r\n") if body[:2] == b"\r\n" else body[1:]
    encoding = ""
    elements: list[Element] = []
    for line in head.decode(errors="replace").replace("\r", "\n").split("\n"):
        words = line.split()
        try:
            if words[:1] == ["format"]:
                encoding = words[1]
            elif words[:1] == ["element"]:
                elements.append(Element(words[1], int(words[2])))
            elif words[:2] == ["property", "list"]:
                elements[-1].properties.append(Property(words[4], TYPES[words[3]], TYPES[words[2]]))
            elif words[:1] == ["property"]:
                elements[-1].properties.append(Property(words[2], TYPES[words[1]]))
        except (IndexError, ValueError, KeyError) as error:
            raise damaged(
                path,
                f"the header has the line {line[:60]!r}",
                expected=f"elements with counts, properties of {', '.join(sorted(TYPES))}",
            ) from error
    if encoding not in _ENCODINGS or any(e.n_rows < 0 for e in elements):
        raise damaged(
            path, f"the encoding is {encoding!r}", expected=f"one of {', '.join(_ENCODINGS)}"
        )
    return Header(encoding, elements), body
