"""Identify the format of a file by its first bytes, independently of its name."""

from __future__ import annotations

import re
import struct
from pathlib import Path
from typing import NamedTuple

from tusqh.readers.formats import suffix_of

#: Number of bytes at the start of a file that identify its format.
_HEAD = 4096


class Content(NamedTuple):
    """The content of a file.

    Parameters
    ----------
    name
        Name of the format, with an article, such as "a PLY file".
    suffixes
        Suffixes with which this format is read; empty for formats that are not read.
    """

    name: str
    suffixes: tuple[str, ...] = ()


# fmt: off
#: Identifying bytes at a fixed offset.
_MAGIC = (
    (0, b"ply\n", Content("a PLY file", (".ply",))),
    (0, b"ply\r", Content("a PLY file", (".ply",))),
    (0, b"glTF", Content("a binary glTF file", (".glb", ".gltf"))),
    (0, b"# vtk DataFile", Content("a legacy VTK file", (".vtk",))),
    (0, b"\x93NUMPY", Content("a NumPy array", (".npy",))),
    (0, b"NRRD000", Content("an NRRD file", (".nrrd", ".nhdr"))),
    (0, b"II*\0", Content("a TIFF file", (".tif", ".tiff"))),
    (0, b"MM\0*", Content("a TIFF file", (".tif", ".tiff"))),
    (0, b"II+\0", Content("a TIFF file", (".tif", ".tiff"))),
    (0, b"MM\0+", Content("a TIFF file", (".tif", ".tiff"))),
    (0, b"\0\0\x27\x0a", Content("a shapefile", (".shp",))),
    (0, b"AutoCAD Binary DXF", Content("a DXF file", (".dxf",))),
    (0, b"PK\x03\x04", Content("a ZIP archive")),
    (0, b"PK\x03\x04", Content("a 3MF file", (".3mf",))),
    (0, b"PK\x05\x06", Content("an empty ZIP archive")),
    (0, b"\x1f\x8b", Content("a file compressed by gzip")),
    (0, b"\x1f\x8b", Content("a NIfTI file", (".nii.gz",))),
    (344, b"n+1\0", Content("a NIfTI file", (".nii", ".nii.gz"))),
    (4, b"n+2\0", Content("a NIfTI file", (".nii", ".nii.gz"))),
    (0, b"SQLite format 3\0", Content("a GeoPackage", (".gpkg",))),
    (0, b"BZh", Content("a file compressed by bzip2")),
    (0, b"\xfd7zXZ\0", Content("a file compressed by xz")),
    (0, b"7z\xbc\xaf\x27\x1c", Content("a 7z archive")),
    (0, b"Rar!\x1a\x07", Content("a RAR archive")),
    (257, b"ustar", Content("a tar archive")),
    (0, b"%PDF", Content("a PDF document")),
    (0, b"\x89PNG", Content("a PNG picture", (".png",))),
    (0, b"\xff\xd8\xff", Content("a JPEG picture", (".jpg", ".jpeg"))),
    (0, b"GIF8", Content("a GIF picture")),
    (0, b"\x89HDF", Content("an HDF5 file")),
    (0, b"ISO-10303-21", Content("a STEP file", (".step", ".stp"))),
    (0, b"Kaydara FBX", Content("an FBX file")),
    (0, b"BLENDER", Content("a Blender file")),
    (0, b"$MeshFormat", Content("a Gmsh file")),
    (0, b"\x7fELF", Content("a program")),
    (0, b"version https://git-lfs", Content("a pointer of Git LFS, not the file itself")),
    (72, b"S      1", Content("an IGES file", (".iges", ".igs"))),
    (128, b"DICM", Content("a DICOM file", (".dcm",))),
)
#: Patterns at the start of a text, after blanks and a byte order mark.
_TEXTS = (
    (rb"(?s)solid\b.{0,1000}?\bfacet\b", Content("an STL file in text", (".stl",))),
    (rb"(?:ST)?C?N?4?n?OFF\b", Content("an OFF file", (".off",))),
    (rb"(?:999\r?\n[^\n]*\n\s*)*0\s*\r?\n\s*SECTION\b", Content("a DXF file", (".dxf",))),
    (rb"x0\s*,\s*y0\s*,\s*x1\s*,\s*y1", Content("a CSV file of segments", (".csv",))),
    (rb"(?:(?:#|mtllib |o |g )[^\n]*\n\s*)*v[ \t]+[-+.\d]+[ \t]+[-+.\d]",
     Content("an OBJ file", (".obj",))),
    (rb'(?s)<.{0,3000}?VTKFile[^>]{0,200}?type="ImageData"', Content("a VTK image", (".vti",))),
    (rb'(?s)<.{0,3000}?VTKFile[^>]{0,200}?type="PolyData"', Content("a VTK surface", (".vtp",))),
    (rb'(?s)<.{0,3000}?VTKFile[^>]{0,200}?type="Unstr', Content("a VTK mesh", (".vtu",))),
    (rb"(?s)<.{0,3000}?VTKFile", Content("another VTK file in XML")),
    (rb"(?s)<.{0,3000}?<(?:\w+:)?svg\b|<(?:\w+:)?svg\b", Content("an SVG drawing", (".svg",))),
    (rb"(?:NDims|ObjectType)\s*=", Content("a MetaImage file", (".mha", ".mhd"))),
    (rb"(?s)<.{0,3000}?<(?:\w+:)?kml\b|<(?:\w+:)?kml\b", Content("a KML file", (".kml",))),
    (rb"(?s)<.{0,3000}?xmlns(?::\w+)?=[\"']http://www\.opengis\.net/gml\b",
     Content("a GML file", (".gml",))),
    (rb"(?i)(?:SRID=\d+;)?(?:MULTI)?(?:POLYGON|LINESTRING)\s*Z?M?\s*\(|GEOMETRYCOLLECTION\s*\(",
     Content("a file of well-known text", (".wkt",))),
    (rb"(?s)\{.{0,3000}?\"type\"\s*:\s*\"Topology\"",
     Content("a TopoJSON file", (".topojson",))),
    (rb"(?:\d+[ \t]*\r?\n){8}[\d\s]*\Z", Content("a column of labels", (".spn",))),
    (rb"(?i)<!doctype html|<html", Content("a web page")),
    (rb'(?s)\{.{0,3000}?"(?:asset|bufferViews|accessors)"\s*:', Content("a glTF file", (".gltf",))),
    (rb'(?s)(?!\{.{0,3000}?"type"\s*:\s*"Topology")'
     rb'[\[{].{0,3000}?"(?:type"\s*:\s*"(?:Feature|Geometry|(?:Multi)?[PL])|features"\s*:)',
     Content("a GeoJSON file", (".geojson", ".json"))),
)
# fmt: on


def recognise(path: Path) -> Content | None:
    """Return the content of a file according to its first bytes, None if they are ambiguous.

    Parameters
    ----------
    path
        A regular file.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "part.stl")
    ...     _ = path.write_bytes(b"ply" + bytes([10]))
    ...     recognise(path).name
    'a PLY file'
    """
    with path.open("rb") as file:
        head = file.read(_HEAD)
    suffix = suffix_of(path)
    if suffix == ".stl" and _is_binary_stl(head, path.stat().st_size):
        return None  # Such a file may begin with any 80 bytes.
    found = [content for place, mark, content in _MAGIC if head[place:].startswith(mark)]
    text = head.removeprefix(b"\xef\xbb\xbf").lstrip()
    found += [content for pattern, content in _TEXTS if re.match(pattern, text)]
    if not found and _is_binary_stl(head, path.stat().st_size):
        return Content("a binary STL file", (".stl",))
    # If several formats are possible, the file's suffix decides.
    return next(
        (content for content in found if suffix in content.suffixes), next(iter(found), None)
    )


def _is_binary_stl(head: bytes, size: int) -> bool:
    """Return whether the size of a file matches the number of triangles in its header."""
    n = struct.unpack("<I", head[80:84])[0] if len(head) >= 84 else 0
    return n > 0 and size == 84 + 50 * n
