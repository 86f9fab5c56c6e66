"""The table of file formats: the module that reads each suffix, and the library it needs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from tusqh.errors import GeometryError

if TYPE_CHECKING:
    from tusqh.geometry.kinds import Kind


@dataclass(frozen=True)
class Format:
    """A file format for geometry.

    Parameters
    ----------
    name
        The format's usual name.
    suffixes
        Suffixes of its files, in lower case.
    kind
        Content of its files: an outline or a picture in 2D, a surface or an image in 3D.
    module
        The module in `tusqh.readers` that reads it.
    library
        The optional library that the module imports; None if the core suffices.
    extra
        The extra of tusqh that installs this library.
    unit
        The unit of length that the format fixes; empty if files may state one or none.
    is_map
        Whether coordinates may be longitudes and latitudes.
    growth
        Measured number of bytes of memory that reading needs for each byte of a file; the readers
        of compressed images make better estimates.
    loses
        What such a file cannot hold, or its reader leaves out.
    """

    name: str
    suffixes: tuple[str, ...]
    kind: Kind
    module: str
    library: str | None = None
    extra: str | None = None
    unit: str = ""
    is_map: bool = False
    growth: float = 1.0
    loses: str = ""


# fmt: off
#: All formats, in the order in which messages list them.
FORMATS = (
    Format("GeoJSON", (".geojson", ".json"), "outline", "geojson", is_map=True, growth=8,
           loses="heights; curves are polygons"),
    Format("SVG", (".svg",), "outline", "svg", "svgpathtools", "formats", growth=16,
           loses="text and pictures; curves become segments"),
    Format(
        "shapefile", (".shp",), "outline", "shp", "shapefile", "formats", is_map=True, growth=8,
           loses="heights and the table of attributes"),
    Format("DXF", (".dxf",), "outline", "dxf", "ezdxf", "formats", growth=10,
           loses="text, hatches and layers"),
    Format("CSV of segments", (".csv",), "outline", "segments", growth=12,
           loses="the unit; polygons are only segments"),
    Format("TopoJSON", (".topojson",), "outline", "topojson", is_map=True, growth=12,
           loses="points; coordinates are rounded to its transform"),
    Format("KML", (".kml",), "outline", "kml", is_map=True, growth=12,
           loses="heights; it is always in longitude and latitude"),
    Format("GML", (".gml",), "outline", "gml", is_map=True, growth=12,
           loses="heights; curves are rejected"),
    Format("WKT", (".wkt",), "outline", "wkt", is_map=True, growth=10,
           loses="heights and names"),
    Format("GeoPackage", (".gpkg",), "outline", "geopackage", is_map=True, growth=4,
           loses="heights and the table of attributes"),
    Format("STL", (".stl",), "surface", "stl", growth=6,
           loses="the unit, shared points; binary files have single precision"),
    Format("OBJ", (".obj",), "surface", "obj", growth=20,
           loses="the unit; curved surfaces"),
    Format("PLY", (".ply",), "surface", "ply", growth=12,
           loses="the unit; other elements"),
    Format("OFF", (".off",), "surface", "off", growth=16,
           loses="the unit and parts"),
    Format("glTF", (".glb", ".gltf"), "surface", "gltf", unit="m", growth=8,
           loses="double precision; quantised and compressed files more"),
    Format("3MF", (".3mf",), "surface", "threemf", growth=4,
           loses="supports, lattices of beams and colours"),
    Format(
        "STEP or IGES",
        (".step", ".stp", ".iges", ".igs"),
        "surface",
        "step",
        "cascadio",
        "cad",
        growth=20,
           loses="curved surfaces become triangles of single precision"),
    Format("VTK", (".vtk", ".vtu", ".vtp"), "surface", "vtk", "pyvista", "formats", growth=8,
           loses="the unit; fields"),
    Format("VTK image", (".vti",), "image", "vti", "pyvista", "formats", growth=3,
           loses="the unit"),
    Format("NumPy array", (".npy",), "image", "npy", growth=2,
           loses="the unit, the size and the place of voxels"),
    Format("TIFF stack", (".tif", ".tiff"), "image", "tiff", "tifffile", "formats", growth=1,
           loses="place and directions; the unit, but for ImageJ and OME"),
    Format("SPN of Sculpt", (".spn",), "image", "spn", growth=7,
           loses="the unit, the size, the place and the number of voxels"),
    Format("NRRD", (".nrrd", ".nhdr"), "image", "nrrd", "nrrd", "formats", growth=1,
           loses="the meaning of colours"),
    Format("NIfTI", (".nii", ".nii.gz"), "image", "nifti", growth=1,
           loses="the fourth axis and later ones"),
    Format("MetaImage", (".mha", ".mhd"), "image", "metaimage", growth=1,
           loses="the unit"),
    Format("DICOM", (".dcm",), "image", "dicom", "pydicom", "formats", growth=3,
           loses="other series, and overlays"),
    Format("PNG", (".png",), "picture", "picture", "PIL", "formats",
           loses="the unit, the size and the place of pixels; palettes"),
    Format("JPEG", (".jpg", ".jpeg"), "picture", "picture", "PIL", "formats",
           loses="as PNG, and exact grey values near borders"),
)
# fmt: on


_DOUBLE = ".nii.gz"

#: What to do with files of formats that are not read, by suffix.
_REMEDIES = {
    **dict.fromkeys(
        (".sldprt", ".sldasm", ".ipt", ".prt", ".catpart", ".x_t", ".x_b", ".jt", ".f3d", ".fcstd"),
        "save it as STEP (.step) in the program that wrote it",
    ),
    **dict.fromkeys((".brep", ".brp"), "save it as STEP (.step), for instance with FreeCAD"),
    ".dwg": "save it as DXF (.dxf)",
    **dict.fromkeys((".fgb", ".tab", ".mif"), "convert it with ogr2ogr OUT.gpkg FILE"),
    ".kmz": "unpack it, and give the KML file in it",
    **dict.fromkeys((".fbx", ".blend", ".3ds", ".dae", ".usdz"), "export it as glTF (.glb)"),
    **dict.fromkeys((".bmp", ".gif", ".webp", ".jp2"), "save it as PNG (.png)"),
    **dict.fromkeys((".ima", ".dicom", ""), "if it is a DICOM file, rename all files to .dcm"),
    **dict.fromkeys((".img", ".hdr", ".mgz"), "convert it to NIfTI (.nii.gz)"),
    **dict.fromkeys((".raw", ".vol"), "write a header for it, as MHD or NHDR"),
    ".msh": "convert it to VTU, for instance with meshio convert",
}


def find_format(geometry: str) -> Format:
    """Return the format of a file by its suffix, regardless of case.

    Parameters
    ----------
    geometry
        A path, or ``package:NAME/FILE``.

    Raises
    ------
    GeometryError
        No format has this suffix.

    Examples
    --------
    >>> find_format("part.STL").name
    'STL'
    """
    suffix = suffix_of(geometry)
    for candidate in FORMATS:
        if suffix in candidate.suffixes:
            return candidate
    raise GeometryError(
        f"files of type {suffix or '(no suffix)'!r} are not supported",
        where=geometry,
        expected=f"one of {', '.join(suffixes_of())}",
        remedy=_REMEDIES.get(suffix, "export the geometry in one of these formats"),
    )


def suffix_of(path: str | Path) -> str:
    """Return the suffix of a file in lower case, with both parts of ``.nii.gz``.

    Parameters
    ----------
    path
        The file, or ``package:NAME/FILE``.

    Examples
    --------
    >>> suffix_of("head.NII.gz"), suffix_of("part.v2.stl")
    ('.nii.gz', '.stl')
    """
    name = Path(path).name.lower()
    return _DOUBLE if name.endswith(_DOUBLE) else Path(name).suffix


def suffixes_of(*kinds: str) -> list[str]:
    """Return the suffixes of the given kinds of format, or of all kinds if none is given.

    Parameters
    ----------
    *kinds
        "outline", "surface", "image" or "picture".

    Examples
    --------
    >>> suffixes_of("image")[:6]
    ['.vti', '.npy', '.tif', '.tiff', '.spn', '.nrrd']
    """
    return [
        suffix
        for candidate in FORMATS
        if not kinds or candidate.kind in kinds
        for suffix in candidate.suffixes
    ]


def dimension_of(geometry: str) -> int:
    """Return 2 for files of outlines and pictures, and 3 for files of surfaces and images.

    Parameters
    ----------
    geometry
        A path, or ``package:NAME/FILE``.

    Raises
    ------
    GeometryError
        No format has this suffix.

    Examples
    --------
    >>> dimension_of("part.STL"), dimension_of("foam.tif"), dimension_of("cut.png")
    (3, 3, 2)
    """
    return 2 if find_format(geometry).kind in ("outline", "picture") else 3
