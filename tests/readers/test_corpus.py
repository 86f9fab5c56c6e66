"""Sample files in installed packages agree with another reader or are refused with a reason."""

import json

import meshio
import numpy as np
import pytest
import pyvista
import shapefile
import shapely
import shapely.geometry
import trimesh
from corpus import sample
from PIL import Image as Picture

from tusqh.errors import GeometryError
from tusqh.geometry.image import Image
from tusqh.geometry.outline import Outline
from tusqh.geometry.outline_facts import OutlineFacts
from tusqh.geometry.soup_facts import SoupFacts
from tusqh.readers.files import read_file

#: The default tests leave out files with more bytes.
LARGE = 2_000_000


def with_marks(path):
    """Return a file as a parameter; large ones are slow."""
    marks = [pytest.mark.slow] if path.stat().st_size > LARGE else []
    return pytest.param(path, id="/".join(path.parts[-2:]), marks=marks)


def measure_apart(path):
    """Return bounding box and size by another reader, None where there is none to ask.

    The size is the signed volume of a closed surface, the area of an open one, the area of an
    outline, or the number of voxels; it is None if it is not defined.
    """
    suffix = path.suffix.lower()
    if suffix == ".npy":
        shape = np.array(np.load(path, mmap_mode="r").shape)
        return np.zeros(3), shape, shape.prod()
    if suffix in (".tif", ".tiff"):
        with Picture.open(path) as picture:
            shape = np.array([*picture.size, picture.n_frames])
            return np.zeros(3), shape, shape.prod()
    if suffix == ".shp":
        with shapefile.Reader(str(path)) as reader:
            shapes = [s for s in reader.iterShapes() if "POLYGON" in s.shapeTypeName]
            area = sum(shapely.area(shapely.geometry.shape(s.__geo_interface__)) for s in shapes)
            box = np.array(reader.bbox)
        return box[:2], box[2:], area or None
    if suffix in (".geojson", ".json"):
        polygons = [shapely.geometry.shape(g) for g in geometries_in(json.loads(path.read_text()))]
        if not polygons:
            return None
        low_high = shapely.total_bounds(polygons)
        return low_high[:2], low_high[2:], sum(map(shapely.area, polygons))
    if suffix in (".obj", ".ply", ".stl", ".off", ".glb", ".gltf"):
        mesh = trimesh.load(path, process=False, force="mesh")
        points = mesh.vertices[np.unique(mesh.faces)]
        mesh.merge_vertices(merge_tex=True, merge_norm=True)
        return points.min(axis=0), points.max(axis=0), (mesh.volume, mesh.area)
    if suffix == ".vtk":
        try:
            mesh = meshio.read(path)
        except (meshio.ReadError, KeyError, SystemExit):
            return None
        points = mesh.points[np.unique(np.concatenate([c.data.ravel() for c in mesh.cells]))]
        return points.min(axis=0), points.max(axis=0), size_by_vtk(path)
    if suffix in (".vtp", ".vtu"):
        mesh = pyvista.read(path).extract_surface(algorithm=None).triangulate()
        bounds = np.reshape(mesh.bounds, (3, 2))
        return bounds[:, 0], bounds[:, 1], size_by_vtk(path)
    return None


def size_by_vtk(path):
    """Return volume and area of the surface in a file of VTK, by its own filters."""
    surface = pyvista.read(path).extract_surface(algorithm=None).triangulate()
    return surface.volume, surface.area


def geometries_in(document):
    """Return the polygons of a GeoJSON document."""
    if document["type"] == "FeatureCollection":
        return [g for feature in document["features"] for g in geometries_in(feature)]
    if document["type"] == "Feature":
        return geometries_in(document["geometry"]) if document["geometry"] else []
    return [document] if document["type"].endswith("Polygon") else []


def size_of(reading):
    """Return the size that belongs to the one of `measure_apart`, and whether it is closed."""
    geometry = reading.geometry
    if isinstance(geometry, Image):
        return geometry.voxels.size
    if isinstance(geometry, Outline):
        return abs(OutlineFacts(geometry).areas.sum())
    facts = SoupFacts(geometry)
    is_closed = not (facts.n_faces != 2 * facts.n_forward).any()
    return (facts.signed_volume if is_closed else None), facts.areas.sum()


@pytest.mark.parametrize("path", [with_marks(path) for path in sample()])
def test_a_sample_file_is_right_or_refused_with_a_reason(path, capfd):
    try:
        reading = read_file(path)
    except GeometryError as error:
        parts = error.found, error.where, error.expected, error.remedy
        assert all(parts)
        assert not any("\n" in part for part in parts)
        assert "Traceback" not in capfd.readouterr().err
        return
    assert not capfd.readouterr().err
    low, high = map(np.asarray, reading.geometry.bounding_box())
    expected = measure_apart(path)
    if expected is None:
        return
    *box, size = expected
    length = np.ptp(box, axis=0).max()
    assert low == pytest.approx(box[0][: len(low)], abs=1e-6 * length)
    assert high == pytest.approx(box[1][: len(high)], abs=1e-6 * length)
    found = size_of(reading)
    if isinstance(size, tuple):
        (volume, area), (their_volume, their_area) = found, size
        assert area == pytest.approx(their_area, rel=1e-5)
        if volume is not None:
            if path.suffix.startswith(".vt"):
                volume = abs(volume)  # VTK's filter gives no sign.
            assert volume == pytest.approx(their_volume, rel=1e-5, abs=1e-9 * length**3)
    elif size is not None and not has_changed_area(reading):
        assert found == pytest.approx(size, rel=1e-6)


def has_changed_area(reading):
    """Return whether a remark says that the area is not the one of the rings of the file."""
    words = ("crossing", "copies", "cross themselves", "beside the outer ring")
    return any(word in remark.what for remark in reading.remarks for word in words)


def test_the_corpus_has_files_of_many_formats():
    assert len({path.suffix.lower() for path in sample()}) >= 6
