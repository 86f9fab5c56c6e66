"""Polygons missing from a mesh, copies, and segments in any direction cause remarks."""

import json
from itertools import pairwise

import numpy as np
import pytest
import pyvista

import tusqh
from tusqh.errors import GeometryError
from tusqh.geometry.outline_facts import OutlineFacts
from tusqh.geometry.soup_facts import SoupFacts
from tusqh.readers.files import read_file

SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])


def write_map(path, rings):
    polygons = [[ring.tolist()] for ring in rings]
    path.write_text(json.dumps({"type": "MultiPolygon", "coordinates": polygons}))
    return path


def test_polygons_below_a_cell_are_counted(tmp_path):
    rng = np.random.default_rng(3)
    small = [0.2 * SQUARE + (x, y) + 0.1 * rng.random(2) for x in range(4, 12) for y in range(12)]
    path = write_map(tmp_path / "a.geojson", [3 * SQUARE, *small])
    result = tusqh.mesh(path, cells=12, threshold=0.5)
    said = [r for r in result.remarks if "smaller than a cell" in r.what]
    # As a second method, check that no square is among the elements of the mesh.
    centres = result.mesh.points[result.mesh.cells].mean(axis=1)
    assert (centres < 3.2).all()
    assert [(r.count, r.what.split()[1]) for r in said] == [(96, "97")]
    assert "cells of 0.2" in said[0].remedy


def test_polygons_of_several_cells_are_not_counted(tmp_path):
    path = write_map(tmp_path / "a.geojson", [3 * SQUARE, 3 * SQUARE + 6])
    result = tusqh.mesh(path, cells=12, threshold=0.5)
    assert not any("smaller than a cell" in r.what for r in result.remarks)


def test_a_polygon_that_is_there_twice_is_named(tmp_path):
    path = write_map(tmp_path / "a.geojson", [SQUARE, 2 * SQUARE + 3, SQUARE[::-1]])
    assert "1 rings that are copies" in "; ".join(map(str, read_file(path).remarks))


@pytest.mark.parametrize("seed", range(8))
def test_segments_of_any_direction_are_chained(tmp_path, seed):
    rng = np.random.default_rng(seed)
    rings = [10 * SQUARE, 4 * SQUARE + 3, SQUARE + 5, 3 * SQUARE + 20]
    pairs = [pair for ring in rings for pair in pairwise(ring)]
    rows = [np.concatenate(pair[:: rng.choice([-1, 1])]) for pair in pairs]
    order = rng.permutation(len(rows))
    text = "".join(",".join(map(repr, rows[k].tolist())) + "\n" for k in order)
    (tmp_path / "a.csv").write_text(f"x0,y0,x1,y1\n{text}")
    reading = read_file(tmp_path / "a.csv")
    assert abs(OutlineFacts(reading.geometry).areas.sum()) == pytest.approx(100 - 16 + 1 + 9)
    assert any("chained by their end points" in remark.what for remark in reading.remarks)


def test_segments_that_agree_stay_as_they_are(tmp_path):
    text = "x0,y0,x1,y1\n0,0,1,0\n1,0,1,1\n1,1,0,0\n5,5,6,6\n"
    (tmp_path / "a.csv").write_text(text)
    reading = read_file(tmp_path / "a.csv")
    assert reading.geometry.n_segments == 4
    assert not reading.remarks


@pytest.mark.parametrize("is_binary", [True, False])
@pytest.mark.parametrize("length", [3, 100, 20_000])
def test_texts_in_a_legacy_vtk_file_are_walked(tmp_path, is_binary, length):
    box = pyvista.Box().triangulate()
    box.user_dict["note"] = "x" * length
    box.field_data["names"] = ["a", "b c", "d"]
    box.save(tmp_path / "a.vtk", binary=is_binary)
    facts = SoupFacts(read_file(tmp_path / "a.vtk").geometry)
    assert facts.signed_volume == pytest.approx(8)
    content = (tmp_path / "a.vtk").read_bytes()
    (tmp_path / "a.vtk").write_bytes(content[: content.find(b"names") + 22])
    with pytest.raises(GeometryError):
        read_file(tmp_path / "a.vtk")
