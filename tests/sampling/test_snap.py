"""`snap` puts planes of the grid on faces, and `offset` moves it by fractions of a cell."""

import numpy as np
import pytest
import trimesh
from typer.testing import CliRunner

import tusqh
from tusqh.cli.app import app
from tusqh.errors import ConfigError, SamplingError
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup import Soup
from tusqh.grid import BackgroundGrid
from tusqh.pipeline.sample import sample
from tusqh.sampling.face_planes import find_face_planes
from tusqh.sampling.fractions import sample_fractions
from tusqh.sampling.layout import lay_as_set
from tusqh.sampling.placement import Placement
from tusqh.settings.grid import Grid, Window
from tusqh.settings.sampling import Sampling


def boxes(*bounds):
    """Return the surfaces of boxes as one soup."""
    parts = [trimesh.creation.box(bounds=b) for b in bounds]
    return Soup.from_parts([(np.asarray(m.vertices), np.asarray(m.faces)) for m in parts])


def plate_with_hole():
    plate = trimesh.creation.box(bounds=[[0, 0, 0], [48, 32, 8]])
    hole = trimesh.creation.cylinder(radius=7, height=8, sections=24)
    hole.apply_translation([24, 16, 4])
    hole.invert()
    part = trimesh.util.concatenate([plate, hole])
    return part.vertices, part.faces


def snapped(geometry, **grid):
    laid = lay_as_set([geometry], None, Grid(snap=True, **grid))
    return laid.grid, laid.placement


def test_a_plate_of_8_mm_stays_8_mm_at_cells_of_1_25_mm():
    result = tusqh.mesh(plate_with_hole(), cell_size=1.25, snap=True, betti=(1, 1, 0))
    assert np.ptp(result.mesh.points, axis=0) == pytest.approx([48, 32, 8], abs=1e-12)
    assert result.fractions.grid.cell_size == 8 / 6
    inside = np.abs(result.fractions.cells - 0.5) < 0.499
    x, y = np.nonzero(inside.any(axis=2))  # Only the hole cuts cells.
    assert np.hypot(*(np.array([x, y]).T * 8 / 6 + 2 / 3 - [24, 16]).T).max() < 8
    assert "6 of 6 planes" in str(result.report)
    assert "cells of 1.33333 instead of 1.25" in str(result.report)
    corner = tusqh.mesh(plate_with_hole(), cell_size=1.25)
    assert np.ptp(corner.mesh.points, axis=0)[2] in (7.5, 8.75)


@pytest.mark.parametrize("seed", range(20))
def test_boxes_with_sides_of_whole_cells_are_exact_at_any_place(seed):
    rng = np.random.default_rng(seed)
    size, low = rng.uniform(0.1, 3), rng.uniform(-50, 50, 3)
    n = rng.integers(2, 9, 3)
    geometry = boxes([low, low + size * n])
    # At most half of the smallest step to the next size that fits too.
    grid, placement = snapped(geometry, cell_size=size * (1 + 0.04 * rng.uniform(-1, 1)))
    assert grid.cell_size == pytest.approx(size, rel=1e-9)
    assert grid.shape == tuple(n)
    assert all(plane.away == 0 for plane in placement.planes)
    fractions = sample_fractions(geometry, grid)
    assert (fractions.cells == 1).all()


@pytest.mark.parametrize("seed", range(20))
def test_no_size_and_position_puts_more_area_on_planes(seed):
    """Against a search over many sizes, where only near misses may count for more."""
    rng = np.random.default_rng(seed)
    corners = [rng.integers(0, 24, (2, 3)) for _ in range(3)]
    geometry = boxes(*([c.min(axis=0), c.max(axis=0) + 1] for c in corners))
    grid, placement = snapped(geometry, cell_size=2.3)
    total = sum(p.share for p in placement.planes)
    found = sum(p.share for p in placement.planes if p.away == 0)
    best = 0.0
    sizes = [d / n for d in range(1, 26) for n in range(1, 20) if 2.3 / 1.5 <= d / n <= 2.3 * 1.5]
    for size in [2.3, *sizes]:
        on = 0.0
        for axis in "xyz":
            mine = [p for p in placement.planes if p.axis == axis]
            on += max(
                sum(q.share for q in mine if abs((q.at - p.at) / size % 1 - 0.5) > 0.499)
                for p in mine
            )
        best = max(best, on)
    assert best - 0.02 * total - 1e-9 <= found <= best + 1e-9
    low, high = geometry.bounding_box()
    assert (np.array(grid.origin) <= np.array(low) + 1e-9).all()
    assert (np.array(grid.upper) >= np.array(high) - 1e-9).all()


def test_planes_have_the_area_that_lies_in_them():
    planes = find_face_planes([boxes([[0, 0, 0], [4, 2, 1]])], 0.5)
    assert [(p.axis, p.at) for p in planes] == [(0, 0), (0, 4), (1, 0), (1, 2), (2, 0), (2, 1)]
    assert [p.share * 28 for p in planes] == pytest.approx([2, 2, 4, 4, 8, 8])
    ball = trimesh.creation.icosphere(subdivisions=5)
    soup = Soup.from_parts([(np.asarray(ball.vertices), np.asarray(ball.faces))])
    assert find_face_planes([soup], 0.1) == []


def test_coordinates_rounded_to_32_bits_lie_on_planes():
    points = np.float64(np.float32(boxes([[0.1, 0.1, 0.1], [10.3, 3.1, 1.3]]).points))
    geometry = Soup(points, boxes([[0] * 3, [1] * 3]).triangles, np.zeros(12, dtype=np.int64))
    result = tusqh.mesh(geometry, cell_size=0.3, snap=True)
    assert result.fractions.grid.shape == (34, 10, 4)
    assert result.built.reference.source == "the exact volume"


def test_outlines_snap_to_their_edges():
    frame = [[(0, 0), (10, 0), (10, 6), (0, 6), (0, 0)], [(2, 2), (2, 4), (8, 4), (8, 2), (2, 2)]]
    outline = Outline.from_chains([np.array(ring, dtype=float) + 0.3 for ring in frame])
    fractions = sample(outline, grid=Grid(cell_size=0.9, snap=True))
    assert fractions.grid.cell_size == pytest.approx(1.0, rel=1e-12)
    assert set(np.unique(fractions.cells)) == {0.0, 1.0}
    assert fractions.cells.sum() == 48


def test_planes_outside_the_window_do_not_count():
    geometry = boxes([[0, 0, 0], [10, 4, 4.37]])
    laid = lay_as_set(
        [geometry], ((1.0, -1.0, -1.0), (9.0, 5.0, 3.0)), Grid(cell_size=1.0, snap=True)
    )
    assert [(p.axis, p.at) for p in laid.placement.planes] == [("y", 0), ("y", 4), ("z", 0)]
    assert laid.grid == BackgroundGrid((8, 6, 4), 1.0, (1.0, -1.0, -1.0))


@pytest.mark.parametrize("seed", range(5))
def test_a_moved_grid_gives_the_fractions_of_the_geometry_moved_back(seed):
    rng = np.random.default_rng(seed)
    ball = trimesh.creation.icosphere(subdivisions=2)
    geometry = Soup.from_parts([(np.asarray(ball.vertices), np.asarray(ball.faces))])
    offset = tuple(rng.uniform(-1, 1, 3).tolist())
    moved = sample(geometry, grid=Grid(cells=6, offset=offset))
    assert moved.placement.offset == offset
    corner = lay_as_set([geometry], None, Grid(cells=6)).grid
    back = geometry.points - np.multiply(offset, corner.cell_size)
    home = Soup(back, geometry.triangles, geometry.parts)
    wide = BackgroundGrid((10,) * 3, corner.cell_size,
                          tuple(o - 2 * corner.cell_size for o in corner.origin))  # fmt: skip
    expected = sample_fractions(home, wide).cells
    shift = np.array(moved.grid.origin) - np.multiply(offset, corner.cell_size) - wide.origin
    first = np.rint(shift / corner.cell_size).astype(int)
    inner = tuple(slice(a, a + n) for a, n in zip(first, moved.grid.shape, strict=True))
    assert np.abs(moved.cells - expected[inner]).max() <= 2**-19
    assert expected.sum() == pytest.approx(expected[inner].sum())


def test_placements_survive_json():
    for placement in (
        snapped(boxes([[0, 0, 0], [10, 4, 4.37]]), cell_size=1.0)[1],
        Placement((0, 0), 0, offset=(0.5, 0.25)),
        Placement((1, 0), 4, 16, error=0.1),
    ):
        assert Placement.from_dict(placement.to_dict()) == placement


def test_the_certificate_is_checked_from_the_geometry(tmp_path):
    for options in ({"snap": True}, {"offset": (0.25, 0.5, -0.25)}):
        tusqh.mesh(plate_with_hole(), cell_size=4, name="plate", **options).save(tmp_path)
        done = CliRunner().invoke(app, ["check", str(tmp_path / "mesh.vtu")])
        assert done.exit_code == 0, done.output
        assert "grid from the geometry" in done.output


def test_slabs_and_several_materials_are_snapped_too(tmp_path):
    path = tmp_path / "plate.vtu"
    how = {"cell_size": 3, "snap": True, "name": "plate", "threshold": 0.5}
    tusqh.mesh(plate_with_hole(), slabs=2, output=path, **how)
    tusqh.mesh(plate_with_hole(), **how).write(tmp_path / "whole.vtu")
    assert path.read_bytes() == (tmp_path / "whole.vtu").read_bytes()
    two = {"a": boxes([[0, 0, 0], [4, 4, 4]]), "b": boxes([[4, 0, 0], [9, 4, 4]])}
    result = tusqh.mesh(two, cell_size=0.9, snap=True)
    assert result.fractions.grid.cell_size == 1.0
    assert any("7 of 7 planes" in str(remark) for remark in result.remarks)


def test_what_cannot_be_placed_is_refused():
    ball = trimesh.creation.icosphere(subdivisions=4)
    ball = Soup.from_parts([(np.asarray(ball.vertices), np.asarray(ball.faces))])
    box = boxes([[0, 0, 0], [4, 2, 1]])
    with pytest.raises(SamplingError, match="no plane faces"):
        snapped(ball, cells=8)
    with pytest.raises(ConfigError, match="snap"):
        tusqh.mesh(box, cells=(8, 4, 2), snap=True)
    with pytest.raises(ConfigError, match="`snap` and `offset`"):
        tusqh.mesh(box, cells=8, snap=True, offset=(0.5, 0, 0))
    with pytest.raises(ConfigError, match="above -1 and below 1"):
        tusqh.mesh(box, cells=8, offset=(1.5, 0, 0))
    with pytest.raises(SamplingError, match=r"`grid\.offset` has 2 numbers"):
        tusqh.mesh(box, cells=8, offset=(0.5, 0))
    with pytest.raises(SamplingError, match="`snap` with `inside: shell`"):
        sample(box, grid=Grid(cells=8, snap=True), sampling=Sampling(inside="shell"))


def test_images_are_told_that_they_cannot_be_snapped():
    result = tusqh.mesh(np.ones((4, 4, 4)), snap=True, image={"full": 1.0})
    assert "`grid.snap` applies only to outlines and surfaces" in str(result.report)


def test_a_window_and_an_offset_go_together():
    geometry = boxes([[0, 0, 0], [4, 4, 4]])
    fractions = sample(
        geometry,
        grid=Grid(cell_size=1, offset=(0.5, 0, 0)),
        window=Window((0.0, 0.0, 0.0), (3.0, 3.0, 3.0)),
    )
    assert fractions.grid == BackgroundGrid((4, 3, 3), 1.0, (-0.5, 0.0, 0.0))
    assert fractions.cells.sum() == pytest.approx(27)
