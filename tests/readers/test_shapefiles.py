"""Shapefiles: rings and lines are read unchanged; other shapes are explained."""

import numpy as np
import pytest
import shapefile

from tusqh.errors import GeometryError
from tusqh.readers.files import read_file
from tusqh.readers.formats import dimension_of

RING = [[0, 0], [0, 4], [4, 4], [4, 0], [0, 0]]
HOLE = [[1, 1], [2, 1], [2, 2], [1, 1]]


def write(path, kind, fill):
    with shapefile.Writer(str(path), shapeType=kind) as writer:
        writer.field("name", "C")
        fill(writer)
    return path


def test_polygons_with_holes_and_empty_shapes(tmp_path):
    def fill(writer):
        writer.poly([RING, HOLE])
        writer.record("land")
        writer.null()
        writer.record("nothing")
        writer.poly([[[8, 0], [8, 1], [9, 1], [8, 0]]])
        writer.record("island")

    outline = read_file(write(tmp_path / "map.shp", shapefile.POLYGON, fill)).geometry
    assert np.bincount(outline.chains).tolist() == [4, 3, 3]
    assert outline.points[:5].tolist() == RING
    assert outline.bounding_box() == ((0, 0), (9, 4))
    assert dimension_of("map.SHP") == 2
    for companion in (".dbf", ".shx"):
        (tmp_path / f"map{companion}").unlink()
    assert read_file(tmp_path / "map.shp").geometry.n_segments == 10


def test_lines_stay_open_and_heights_are_dropped(tmp_path):
    def fill(writer):
        writer.linez([[[0, 0, 5], [1, 0, 6], [1, 2, 7]], [[3, 3, 0], [4, 4, 0]]])
        writer.record("road")

    outline = read_file(write(tmp_path / "roads.shp", shapefile.POLYLINEZ, fill)).geometry
    assert np.bincount(outline.chains).tolist() == [2, 1]
    assert outline.points.tolist() == [[0, 0], [1, 0], [1, 2], [3, 3], [4, 4]]


def test_files_without_outlines_are_explained(tmp_path):
    def fill(writer):
        writer.point(1, 2)
        writer.record("tree")

    path = write(tmp_path / "trees.shp", shapefile.POINT, fill)
    with pytest.raises(GeometryError, match="the geometry is empty"):
        read_file(path)
    path.write_bytes(path.read_bytes()[:60])
    with pytest.raises(GeometryError, match="cannot be read"):
        read_file(path)
    path.write_text("not a shapefile at all, " * 9)
    with pytest.raises(GeometryError, match="cannot be read"):
        read_file(path)


def test_patches_in_space_are_refused(tmp_path):
    def fill(writer):
        writer.multipatch([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]], partTypes=[shapefile.TRIANGLE_STRIP])
        writer.record("roof")

    with pytest.raises(GeometryError, match="MULTIPATCH"):
        read_file(write(tmp_path / "roof.shp", shapefile.MULTIPATCH, fill))
