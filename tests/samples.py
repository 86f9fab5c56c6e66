"""Small valid files of every variant of a format: text and binary, compressed or not."""

import base64
import json
from itertools import pairwise

import ezdxf
import nrrd
import numpy as np
import pyvista
import shapefile
import tifffile
import trimesh

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
    for encoding in ("raw", "gzip", "bzip2", "ascii"):
        nrrd.write(str(folder / f"{encoding}.nrrd"), ball, {"encoding": encoding})


#: Options of the samples that cannot be read without, by suffix.
OPTIONS = {".spn": {"voxels": [9, 8, 7]}}


def write_samples(folder):
    """Write files of every format into a folder, and return them."""
    write_outlines(folder)
    write_surfaces(folder)
    write_images(folder)
    return sorted(path for path in folder.iterdir() if path.suffix not in (".dbf", ".shx"))
