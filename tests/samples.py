"""Small valid files of every variant of a format: text and binary, compressed or not."""

import base64
import gzip
import json
import sqlite3
import struct
import zipfile
import zlib
from contextlib import closing
from itertools import pairwise

import DracoPy
import ezdxf
import nrrd
import numpy as np
import pydicom
import pyvista
import shapefile
import shapely
import tifffile
import trimesh
from PIL import Image as Pillow
from step_files import iges_patch, step_box

from tusqh.settings.lengths import Lengths

RING = np.array([[0.0, 0], [4, 0], [4, 3], [2, 4], [0, 3], [0, 0]])
HOLE = np.array([[1.0, 1], [1, 2], [2, 2], [2, 1], [1, 1]])


def write_outlines(folder):
    """Write a polygon with a hole in every format of outlines."""
    polygon = {"type": "Polygon", "coordinates": [RING.tolist(), HOLE.tolist()]}
    line = {"type": "LineString", "coordinates": [[5, 5], [6, 6]]}
    features = [{"type": "Feature", "properties": {}, "geometry": g} for g in (polygon, line)]
    collection = {"type": "FeatureCollection", "features": features}
    (folder / "map.geojson").write_text(json.dumps(collection))
    (folder / "polygon.json").write_text(json.dumps(polygon))
    path = "".join(
        "M" + " L".join(f"{x:g},{y:g}" for x, y in ring[:-1]) + " Z " for ring in (RING, HOLE)
    )
    (folder / "drawing.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="40mm" viewBox="0 0 40 40">'
        f'<g transform="translate(3 4) rotate(10)"><path fill-rule="evenodd" d="{path}"/></g>'
        '<circle cx="20" cy="20" r="5"/><text>a</text></svg>'
    )
    with shapefile.Writer(str(folder / "shape"), shapeType=shapefile.POLYGON) as writer:
        writer.field("n", "N")
        writer.poly([RING[::-1].tolist(), HOLE[::-1].tolist()])
        writer.record(1)
    drawing = ezdxf.new("R2000", setup=False)
    space = drawing.modelspace()
    space.add_lwpolyline(RING[:-1].tolist(), close=True)
    space.add_circle((2, 1.5), 0.5)
    for start, end in pairwise(HOLE):
        space.add_line(start + 10, end + 10)
    drawing.saveas(folder / "drawing.dxf")
    drawing.saveas(folder / "binary.dxf", fmt="bin")
    rows = [f"{a[0]},{a[1]},{b[0]},{b[1]}" for a, b in pairwise(RING)]
    (folder / "segments.csv").write_text("\n".join(["x0,y0,x1,y1", *rows]) + "\n")


def write_surfaces(folder):
    """Write a box in every format of surfaces."""
    box = trimesh.creation.box((1, 2, 3))
    for name, options in (
        *(("binary.stl", {}), ("text.stl", {"file_type": "stl_ascii"}), ("box.obj", {})),
        *(("binary.ply", {}), ("text.ply", {"encoding": "ascii"})),
        *(("box.off", {}), ("box.glb", {})),
    ):
        box.export(folder / name, **options)
    points = box.vertices.astype("<f4").tobytes()
    corners = box.faces.astype("<u2").tobytes()
    uri = "data:application/octet-stream;base64," + base64.b64encode(points + corners).decode()
    views = [(0, len(points)), (len(points), len(corners))]
    document = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "translation": [1, 0, 0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteOffset": o, "byteLength": n} for o, n in views],
        "buffers": [{"byteLength": len(points + corners), "uri": uri}],
    }
    (folder / "box.gltf").write_text(json.dumps(document))
    write_threemf(folder / "box.3mf", box.vertices, box.faces)
    write_draco(folder / "draco.glb", box.vertices, box.faces)
    for name in ("box.step", "box.stp"):
        (folder / name).write_text(step_box((0.0, 0.0, 0.0), (1.0, 2.0, 3.0)))
    for name in ("plate.iges", "plate.igs"):
        (folder / name).write_text(iges_patch(2.0, 3.0))
    surface = pyvista.Box((0, 1, 0, 2, 0, 3))
    noted = surface.copy()
    noted.user_dict["note"] = "any text"
    grid = pyvista.ImageData(dimensions=(2, 3, 2)).cast_to_unstructured_grid()
    for name, dataset, is_binary in (
        *(("binary.vtk", surface, True), ("text.vtk", surface, False), ("grid.vtk", grid, True)),
        *(("texts.vtk", noted, True), ("noted.vtk", noted, False)),
        *(("box.vtp", surface, True), ("text.vtp", surface, False)),
        *(("grid.vtu", grid, True), ("text.vtu", grid, False)),
    ):
        dataset.save(folder / name, binary=is_binary)


def write_maps(folder):
    """Write a polygon with a hole in every format of maps but those above."""
    shape = shapely.Polygon(RING, [HOLE])
    (folder / "polygon.wkt").write_text(f"{shape.wkt}\nMULTILINESTRING ((0 0, 1 1))\n")
    arcs = [RING.tolist(), HOLE.tolist()]
    item = {"type": "Polygon", "arcs": [[0], [1]]}
    (folder / "shared.topojson").write_text(
        json.dumps({"type": "Topology", "objects": {"plate": item}, "arcs": arcs})
    )
    rings = "".join(
        f"<{side}><LinearRing><coordinates>"
        + " ".join(f"{x},{y},0" for x, y in ring)
        + f"</coordinates></LinearRing></{side}>"
        for side, ring in (("outerBoundaryIs", RING), ("innerBoundaryIs", HOLE))
    )
    (folder / "plate.kml").write_text(
        '<kml xmlns="http://www.opengis.net/kml/2.2"><Document><Placemark><name>plate</name>'
        f"<Polygon>{rings}</Polygon></Placemark></Document></kml>"
    )
    write_geopackage(folder / "plate.gpkg", [shape])
    write_gml(folder / "plate.gml", [RING, HOLE])


def write_gml(path, rings, *, system=None, is_old=False):
    """Write a polygon with holes as GML of version 3 or 2."""
    names = ("outerBoundaryIs", "innerBoundaryIs") if is_old else ("exterior", "interior")
    sides = ""
    for k, ring in enumerate(rings):
        blank = "," if is_old else " "
        text = " ".join(f"{float(x)!r}{blank}{float(y)!r}" for x, y in ring)
        kind, side = "coordinates" if is_old else "posList", names[k > 0]
        sides += f"<gml:{side}><gml:LinearRing><gml:{kind}>{text}</gml:{kind}></gml:LinearRing>"
        sides += f"</gml:{side}>"
    stated = f' srsName="{system}"' if system else ""
    path.write_text(
        '<a:map xmlns:a="http://example.org/a" xmlns:gml="http://www.opengis.net/gml/3.2">'
        f"<gml:featureMember><a:plate><a:shape><gml:Polygon{stated}>{sides}</gml:Polygon></a:shape>"
        "</a:plate></gml:featureMember></a:map>"
    )


def write_geopackage(path, shapes, *, srs=(-1, "NONE", -1, "undefined")):
    """Write shapes of shapely as a GeoPackage with one layer."""
    path.unlink(missing_ok=True)
    with closing(sqlite3.connect(path)) as base:
        base.executescript(
            "PRAGMA application_id = 0x47504B47;"
            "CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT, srs_id INTEGER PRIMARY KEY,"
            " organization TEXT, organization_coordsys_id INTEGER, definition TEXT);"
            "CREATE TABLE gpkg_geometry_columns (table_name TEXT, column_name TEXT,"
            " geometry_type_name TEXT, srs_id INTEGER, z TINYINT, m TINYINT);"
            "CREATE TABLE parts (fid INTEGER PRIMARY KEY, geom BLOB);"
        )
        base.execute("INSERT INTO gpkg_spatial_ref_sys VALUES ('', ?, ?, ?, ?)", srs)
        row = "('parts', 'geom', 'GEOMETRY', ?, 0, 0)"
        base.execute(f"INSERT INTO gpkg_geometry_columns VALUES {row}", srs[:1])
        for shape in shapes:
            head = b"GP\0\1" + struct.pack("<i", srs[0])
            base.execute("INSERT INTO parts (geom) VALUES (?)", (head + shapely.to_wkb(shape),))
        base.commit()


def write_threemf(path, points, triangles, *, unit="millimeter", transform=None):
    """Write a solid as 3MF, in a component at a place."""
    vertices = "".join(f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>' for x, y, z in points.tolist())
    faces = "".join(
        f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in np.asarray(triangles).tolist()
    )
    place = f' transform="{transform}"' if transform else ""
    model = (
        f'<model unit="{unit}" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">'
        f'<resources><object id="1" name="box"><mesh><vertices>{vertices}</vertices>'
        f'<triangles>{faces}</triangles></mesh></object><object id="2"><components>'
        f'<component objectid="1"{place}/></components></object></resources>'
        '<build><item objectid="2"/></build></model>'
    )
    relation = (
        '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
        '<Relationship Id="r" Target="/3D/3dmodel.model" '
        'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
    )
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("_rels/.rels", relation)
        archive.writestr("3D/3dmodel.model", model)


def write_draco(path, points, triangles):
    """Write a surface as glTF whose triangles are compressed by Draco."""
    packed = DracoPy.encode(points, faces=np.asarray(triangles), quantization_bits=20)
    packed += bytes(-len(packed) % 4)
    use = {"bufferView": 0, "attributes": {"POSITION": 0}}
    document = {
        "asset": {"version": "2.0"},
        "extensionsRequired": ["KHR_draco_mesh_compression"],
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [
            {
                "primitives": [
                    {
                        "attributes": {"POSITION": 0},
                        "indices": 1,
                        "extensions": {"KHR_draco_mesh_compression": use},
                    }
                ]
            }
        ],
        "accessors": [
            {"componentType": 5126, "count": len(points), "type": "VEC3"},
            {"componentType": 5125, "count": 3 * len(triangles), "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": len(packed)}],
        "buffers": [{"byteLength": len(packed)}],
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    size = 12 + 8 + len(text) + 8 + len(packed)
    path.write_bytes(
        struct.pack("<4sII", b"glTF", 2, size)
        + struct.pack("<I4s", len(text), b"JSON")
        + text
        + struct.pack("<I4s", len(packed), b"BIN\0")
        + packed
    )


def write_nifti(path, voxels, affine, *, unit=2, order="<"):
    """Write an image as NIfTI-1, with its affine map in the sform."""
    code = {"u1": 2, "i2": 4, "i4": 8, "f4": 16, "f8": 64, "u2": 512}[voxels.dtype.str[1:]]
    header = bytearray(352)
    shape = [*voxels.shape, 1, 1, 1, 1, 1][:7]
    struct.pack_into(order + "i", header, 0, 348)
    struct.pack_into(order + "8h", header, 40, voxels.ndim, *shape)
    struct.pack_into(order + "2h", header, 70, code, 8 * voxels.itemsize)
    struct.pack_into(order + "8f", header, 76, 1, *np.linalg.norm(affine[:, :3], axis=0), *[1] * 4)
    struct.pack_into(order + "3f", header, 108, 352, 1, 0)
    struct.pack_into("B", header, 123, unit)
    struct.pack_into(order + "2h", header, 252, 0, 1)
    struct.pack_into(order + "12f", header, 280, *np.asarray(affine).ravel())
    header[344:348] = b"n+1\0"
    content = bytes(header) + voxels.astype(voxels.dtype.newbyteorder(order)).tobytes(order="F")
    path.write_bytes(gzip.compress(content, mtime=0) if path.suffix == ".gz" else content)


def write_metaimage(path, voxels, steps, first, *, is_packed=False):
    """Write an image as MetaImage; `steps` has one direction in a row."""
    sides = np.linalg.norm(steps, axis=1)
    kind = {"u1": "MET_UCHAR", "u2": "MET_USHORT", "f4": "MET_FLOAT"}[voxels.dtype.str[1:]]
    data = voxels.tobytes(order="F")
    data = zlib.compress(data) if is_packed else data
    is_apart = path.suffix == ".mhd"
    lines = {
        "ObjectType": "Image",
        "NDims": 3,
        "BinaryData": "True",
        "CompressedData": is_packed,
        "TransformMatrix": " ".join(map(repr, (steps / sides[:, None]).ravel().tolist())),
        "Offset": " ".join(map(repr, np.asarray(first).tolist())),
        "ElementSpacing": " ".join(map(repr, sides.tolist())),
        "DimSize": " ".join(map(str, voxels.shape)),
        "ElementType": kind,
        "ElementDataFile": path.with_suffix(".zraw").name if is_apart else "LOCAL",
    }
    text = "".join(f"{key} = {value}\n" for key, value in lines.items()).encode()
    path.write_bytes(text + (b"" if is_apart else data))
    if is_apart:
        path.with_suffix(".zraw").write_bytes(data)


def write_dicom(path, pixels, *, rows=(1, 0, 0), columns=(0, 1, 0), first=(0, 0, 0), spacing=1.0):
    """Write a slice [row, column], or frames, of a series as DICOM without compression."""
    found = pydicom.Dataset()
    found.file_meta = pydicom.dataset.FileMetaDataset()
    found.file_meta.TransferSyntaxUID = pydicom.uid.ExplicitVRLittleEndian
    found.file_meta.MediaStorageSOPClassUID = pydicom.uid.CTImageStorage
    found.file_meta.MediaStorageSOPInstanceUID = "1.2.3.4"
    found.SOPClassUID, found.SOPInstanceUID = pydicom.uid.CTImageStorage, "1.2.3.4"
    found.SeriesInstanceUID = "1.2.3"
    found.PixelSpacing = [spacing, spacing]
    found.SpacingBetweenSlices = spacing
    found.ImageOrientationPatient = [*map(float, rows), *map(float, columns)]
    found.ImagePositionPatient = [*map(float, first)]
    found.Rows, found.Columns = pixels.shape[-2:]
    if pixels.ndim == 3:
        found.NumberOfFrames = len(pixels)
    found.SamplesPerPixel, found.PhotometricInterpretation = 1, "MONOCHROME2"
    found.BitsAllocated, found.BitsStored, found.HighBit, found.PixelRepresentation = 8, 8, 7, 0
    data = pixels.astype(np.uint8).tobytes()
    found.PixelData = data + bytes(len(data) % 2)
    found.save_as(path, enforce_file_format=True)


def write_images(folder):
    """Write a ball in every format of images."""
    place = np.indices((9, 8, 7)) - 4
    ball = (np.linalg.norm(place, axis=0) < 3).astype(np.uint8) * 200
    np.save(folder / "ball.npy", ball)
    np.save(folder / "fractions.npy", ball / 200)
    for name, options in (
        *(("ball.tif", {}), ("packed.tif", {"compression": "zlib"})),
        *(
            ("lzw.tif", {"compression": "lzw"}),
            ("imagej.tif", {"imagej": True, "metadata": {"axes": "ZYX"}}),
        ),
        ("pages.tiff", {"photometric": "minisblack", "metadata": None}),
    ):
        tifffile.imwrite(folder / name, ball, **options)
    image = pyvista.ImageData(dimensions=(10, 9, 8), spacing=(2, 2, 2), origin=(1, 2, 3))
    image.cell_data["grey"] = ball.ravel(order="F")
    image.save(folder / "cells.vti")
    image = pyvista.ImageData(dimensions=ball.shape)
    image.point_data["grey"] = ball.ravel(order="F")
    image.save(folder / "points.vti", binary=False)
    rows = [str(k) for k in (ball // 200).ravel().tolist()]
    (folder / "ball.spn").write_text("\n".join(rows) + "\n")
    write_nifti(folder / "ball.nii", ball, np.eye(4)[:3])
    write_nifti(folder / "big.nii.gz", ball, np.eye(4)[:3], order=">")
    turned = np.array([[0.8, -0.6, 0, 0], [0.6, 0.8, 0, 0], [0, 0, 1, 0]])
    write_nifti(folder / "turned.nii", ball, turned)
    write_metaimage(folder / "ball.mha", ball, np.eye(3), [0.0, 0, 0])
    write_metaimage(folder / "ball.mhd", ball, np.eye(3), [0.0, 0, 0], is_packed=True)
    write_dicom(folder / "frames.dcm", ball)
    nrrd.write(str(folder / "apart.nhdr"), ball, {"encoding": "raw"})
    Pillow.fromarray(ball[:, :, 3]).save(folder / "ball.png")
    Pillow.fromarray(ball[:, :, 3]).save(folder / "ball.jpg")
    Pillow.fromarray(ball[:, :, 3]).save(folder / "ball.jpeg")
    for encoding in ("raw", "gzip", "bzip2", "ascii"):
        nrrd.write(str(folder / f"{encoding}.nrrd"), ball, {"encoding": encoding})


#: Options of the samples that cannot be read without, by suffix.
OPTIONS = {".spn": {"voxels": [9, 8, 7]}}

#: Units and coordinate systems of the samples that cannot be read without, by suffix.
LENGTHS = {".kml": Lengths(crs="utm")}


def write_samples(folder):
    """Write files of every format into a folder, and return them."""
    write_outlines(folder)
    write_surfaces(folder)
    write_maps(folder)
    write_images(folder)
    others = (".dbf", ".shx", ".raw", ".zraw")
    return sorted(path for path in folder.iterdir() if path.suffix not in others)
