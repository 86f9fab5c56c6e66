"""Meshes that agree with their geometry get no warning; others get the right warning."""

import numpy as np
import pytest

import tusqh
from tusqh.errors import TopologyError
from tusqh.files import TABLES_OF_ALL_MODELS
from tusqh.geometry.outline import Outline
from tusqh.quality.summary import summarise_verdict


def box(*sides):
    """Return the points and triangles of a box from the origin."""
    points = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * sides
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return points.astype(float), np.array(triangles)


def square(size, x=0.0, y=0.0):
    return size * np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]) + [x, y]


def rows(result, holds):
    table = result.report.verdict
    return table[table["holds"] == holds].set_index("id")


def test_a_solid_that_fits_its_grid_is_suitable_without_warnings():
    result = tusqh.mesh(box(4, 4, 2), cells=8)
    assert result.report.facts["reference_volume"] == pytest.approx(32, rel=1e-12)
    assert str(result.judgement).startswith("suitable")
    assert not result.report.has_warnings
    assert rows(result, "yes").loc["volume", "found"] == "1.0000 of the exact volume"


def test_a_plate_thinner_than_a_cell_is_not_suitable_and_the_cell_size_is_named():
    result = tusqh.mesh(box(220, 220, 3), cells=24)
    failed = rows(result, "no")
    assert list(failed.index) == ["volume"]
    assert failed.loc["volume", "found"] == "3.0556 of the exact volume"
    assert "`--cell-size 1.5`" in failed.loc["volume", "remedy"]
    assert "ties" in rows(result, "warning").index


def test_a_volume_a_little_off_is_a_warning_in_the_certificate_too(tmp_path):
    outline = Outline.from_chains([square(10.0)])
    window = ((-1, -1), (12, 12))
    result = tusqh.mesh(outline, cells=4, window=window, placement="corner", name="square")
    assert rows(result, "warning").loc["volume", "remedy"]
    result.save(tmp_path)
    assert '"id": "volume"' in (tmp_path / "certificate.json").read_text().replace('":"', '": "')


def test_small_components_are_counted_with_the_cell_size_that_resolves_them():
    outline = Outline.from_chains([square(10.0), square(1.0, 12.0, 3.0)])
    result = tusqh.mesh(outline, cells=13)
    row = rows(result, "warning").loc["small_components"]
    assert row["found"] == "2 components, 1 of at most 4 cells"
    assert "--min-cells 5" in row["remedy"]


def test_a_sheet_without_an_inside_is_called_open():
    points = [[x, y, 0.3 * np.sin(x + y)] for x in range(6) for y in range(6)]
    low = [6 * i + j for i in range(5) for j in range(5)]
    triangles = [t for a in low for t in ((a, a + 6, a + 7), (a, a + 7, a + 1))]
    result = tusqh.mesh((np.array(points), np.array(triangles)), cells=12, threshold=0.1)
    assert "open_surface" in rows(result, "warning").index


def test_a_volume_that_no_threshold_matches_is_an_error_that_names_what_helps():
    with pytest.raises(TopologyError, match=r"nearest mesh is 3\.05.*") as caught:
        tusqh.mesh(box(220, 220, 3), cells=24, volume="match")
    assert "`--cell-size 1.5`" in str(caught.value)


def test_a_row_of_the_table_of_verdicts_says_ratio_and_warnings():
    for cells, verdict, warned in ((8, "suitable", ""), (24, "not suitable", "cells whose")):
        sides = (4, 4, 2) if cells == 8 else (220, 220, 3)
        result = tusqh.mesh(box(*sides), cells=cells, placement="corner")
        row = summarise_verdict(result.report.facts, result.report.verdict, file="a.stl")
        assert tuple(row) == TABLES_OF_ALL_MODELS[0].columns
        assert row["volume_ratio"] == pytest.approx(row["volume"] / np.prod(sides))
        assert row["verdict"] == verdict
        assert warned in row["warnings"]
