"""Grids that are turned, and cells that are boxes: the same meshes as of the geometry mapped."""

import numpy as np
import pytest
import trimesh
from typer.testing import CliRunner

import tusqh
from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.antialias.scheme import PINCH_TEMPLATES
from tusqh.cli.app import app
from tusqh.errors import ConfigError, SamplingError
from tusqh.grid import BackgroundGrid
from tusqh.grid.frame import Frame
from tusqh.meshes.export import read_vtu, write_vtu
from tusqh.sampling.fractions import VolumeFractions
from tusqh.sampling.io import load_fractions, save_fractions
from tusqh.settings.policy import Policy

ANGLES = (20.0, -35.0, 50.0)


def rotation(angles=ANGLES):
    """Return the rotation about x, then y, then z."""
    return trimesh.transformations.euler_matrix(*np.deg2rad(angles), axes="sxyz")[:3, :3]


def torus(stretch=(1.0, 1.0, 1.0), *, is_open=False):
    made = trimesh.creation.torus(1.0, 0.4, major_sections=24, minor_sections=12)
    return np.asarray(made.vertices) * stretch, np.asarray(made.faces)[int(is_open) :]


def star(seed=0):
    """Return an outline with a hole, closed."""
    rng = np.random.default_rng(seed)
    angle = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    outer = rng.uniform(0.8, 1.2, 40)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    points = np.vstack([outer, 0.4 * outer[::-1]])
    lines = np.array([[k, (k + 1) % 40] for k in range(40)])
    return points, np.vstack([lines, lines + 40])


def plate(sides):
    made = trimesh.creation.box(bounds=[[0, 0, 0], sides])
    return np.asarray(made.vertices), np.asarray(made.faces)


@pytest.mark.parametrize("is_open", [False, True])
def test_turned_geometry_in_a_turned_grid_gives_the_mesh_turned(is_open):
    points, faces = torus(is_open=is_open)
    plain = tusqh.mesh((points, faces), cells=14, threshold=0.37)
    for how in (ANGLES, rotation().T.ravel().tolist()):
        turned = tusqh.mesh((points @ rotation().T, faces), cells=14, threshold=0.37, rotate=how)
        assert np.array_equal(turned.mesh.cells, plain.mesh.cells)
        assert np.abs(turned.mesh.points - plain.mesh.points @ rotation().T).max() < 1e-9
        assert str(turned.report.measured) == "(1, 1, 0)"
        places = [f"birth_{axis}" for axis in "xyz"]
        expected = plain.diagram[places].to_numpy(float) @ rotation().T
        assert np.allclose(turned.diagram[places].to_numpy(float), expected, equal_nan=True)


def test_boxes_give_the_mesh_of_the_stretched_geometry():
    stretch = np.array([2.0, 1.0, 0.5])
    how = {"threshold": 0.37, "placement": "corner"}
    plain = tusqh.mesh(torus(), cell_size=0.19, **how)
    points, faces = torus(stretch)
    boxes = tusqh.mesh((points, faces), cell_size=(0.19 * stretch).tolist(), **how)
    assert np.array_equal(boxes.mesh.cells, plain.mesh.cells)
    assert np.abs(boxes.mesh.points - plain.mesh.points * stretch).max() < 1e-9
    assert boxes.fractions.volume() == pytest.approx(plain.fractions.volume())  # 2 * 1 * 0.5 = 1.
    assert boxes.built.reference.source == "the exact volume"
    assert "boxes of 0.38 x 0.19 x 0.095" in str(boxes.report)
    assert boxes.report.is_suitable
    turned = tusqh.mesh(
        (points @ rotation().T, faces),
        cell_size=(0.19 * stretch).tolist(), rotate=ANGLES, **how
    )  # fmt: skip
    assert np.abs(turned.mesh.points - (plain.mesh.points * stretch) @ rotation().T).max() < 1e-9


def test_outlines_too():
    points, lines = star()
    plain = tusqh.mesh((points, lines), cell_size=0.11, threshold=0.37, fit=True)
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    turn = np.array([[c, -s], [s, c]])
    turned = tusqh.mesh(
        (points @ turn.T, lines), cell_size=0.11, threshold=0.37, fit=True, rotate=(30,)
    )
    assert np.abs(turned.staircase.points - plain.staircase.points @ turn.T).max() < 1e-9
    assert np.abs(turned.mesh.points - plain.mesh.points @ turn.T).max() < 1e-6
    how = {"threshold": 0.37, "placement": "corner"}
    plain = tusqh.mesh((points, lines), cell_size=0.11, **how)
    boxes = tusqh.mesh((points * (3, 1), lines), cell_size=(0.33, 0.11), **how)
    assert np.abs(boxes.mesh.points - plain.mesh.points * (3, 1)).max() < 1e-9


def test_the_fit_follows_a_turned_grid():
    points, faces = torus()
    plain = tusqh.mesh((points, faces), cells=12, fit=True)
    turned = tusqh.mesh((points @ rotation().T, faces), cells=12, fit=True, rotate=ANGLES)
    assert np.abs(turned.staircase.points - plain.staircase.points @ rotation().T).max() < 1e-9
    away = [r.fit.fitted.distances[["mean", "max"]].to_numpy(float) for r in (plain, turned)]
    assert away[0] == pytest.approx(away[1], rel=0.05, abs=1e-3)  # Rounding changes its steps.
    assert turned.report.is_suitable


def test_axes_follow_the_faces_or_the_principal_axes():
    points, faces = plate((6, 4, 1.5))
    turned = points @ rotation().T
    for align in ("faces", "principal"):
        result = tusqh.mesh((turned, faces), cell_size=0.5, snap=True, align=align)
        assert sorted(result.fractions.grid.shape) == [3, 8, 12]
        assert np.abs(result.fractions.cells - 1).max() < 1e-5
        assert result.mesh.measurement.volume == pytest.approx(36, rel=1e-9)
    rod, faces = plate((1, 1, 6))  # Its principal axes are unknown but for one.
    result = tusqh.mesh((rod @ rotation().T, faces), cell_size=0.25, align="principal")
    axes = np.array(result.fractions.grid.frame.axes)
    assert np.abs(axes @ rotation()[:, 2]).max() == pytest.approx(1)
    assert axes @ axes.T == pytest.approx(np.eye(3))
    assert np.linalg.det(axes) == pytest.approx(1)
    untouched = tusqh.mesh(plate((6, 4, 1)), cell_size=0.5, align="faces").fractions.grid
    assert untouched.frame == Frame()


def test_each_axis_is_snapped_by_itself_where_cells_may_be_boxes():
    result = tusqh.mesh(plate((50, 31, 8)), cell_size=(1.25, 1.25, 1.25), snap=True)
    assert result.fractions.grid.sides == pytest.approx((1.25, 31 / 25, 8 / 6))
    assert np.ptp(result.mesh.points, axis=0) == pytest.approx([50, 31, 8], abs=1e-9)
    assert (result.fractions.cells == 1).all()
    assert "6 of 6 planes" in str(result.report)
    at = [plane.at for plane in result.fractions.placement.planes]
    assert at == pytest.approx([0, 50, 0, 31, 0, 8], abs=1e-9)
    cubes = tusqh.mesh(plate((50, 31, 8)), cell_size=1.25, snap=True)
    sizes = cubes.fractions.grid.sides
    assert sizes == pytest.approx((1.0,) * 3)  # The only size that fits all.


def test_certificates_are_checked_in_the_same_frame(tmp_path):
    points, faces = torus((2, 1, 1))
    for options in (
        {"rotate": ANGLES, "cells": 12},
        {"cell_size": (0.5, 0.25, 0.2)},
        {"cell_size": (0.5, 0.25, 0.2), "align": "principal", "offset": (0.5, 0, 0)},
        {"align": "principal", "cells": 12, "fit": True},
    ):
        result = tusqh.mesh((points, faces), name="ring", **options)
        result.save(tmp_path)
        for name in ("mesh.vtu", "fitted.vtu")[: 1 + ("fit" in options)]:
            done = CliRunner().invoke(app, ["check", str(tmp_path / name)])
            assert done.exit_code == 0, done.output


def test_slabs_and_several_materials_are_turned_too(tmp_path):
    points, faces = torus()
    turned = points @ rotation().T
    path, how = tmp_path / "ring.vtu", {"cells": 14, "rotate": ANGLES, "threshold": 0.5}
    tusqh.mesh((turned, faces), slabs=2, output=path, name="ring", **how)
    tusqh.mesh((turned, faces), name="ring", **how).write(tmp_path / "whole.vtu")
    assert path.read_bytes() == (tmp_path / "whole.vtu").read_bytes()
    ball = trimesh.creation.icosphere(radius=0.55)
    two = {"ring": (points, faces), "ball": (ball.vertices, ball.faces)}
    plain = tusqh.mesh(two, cells=14)
    both = {name: (np.asarray(p) @ rotation().T, f) for name, (p, f) in two.items()}
    found = tusqh.mesh(both, cells=14, rotate=ANGLES)
    assert found.mesh.points.shape == plain.mesh.points.shape
    assert np.abs(found.mesh.points - plain.mesh.points @ rotation().T).max() < 1e-9
    stretched = {name: (np.asarray(p) * (1, 2, 1), f) for name, (p, f) in two.items()}
    found = tusqh.mesh(stretched, cell_size=(0.2, 0.4, 0.2))
    plain = tusqh.mesh(two, cell_size=0.2)
    assert np.abs(found.mesh.points - plain.mesh.points * (1, 2, 1)).max() < 1e-9


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("seed", range(1, 5))
def test_the_bound_of_boxes_holds_for_other_noise(dim, seed, tmp_path):
    rng = np.random.default_rng(seed)
    frame, size = Frame.of_sides(None, np.exp(rng.uniform(-0.7, 0.7, dim)).tolist())
    grid = BackgroundGrid((10,) * dim, size, (0.0,) * dim, frame=frame)
    noise = VolumeFractions.from_values(grid, 4, rng.random((21,) * dim))
    mesh = build_mesh(CellSets(noise, Policy(bridges="none")).at(0.45), grid).mesh
    write_vtu(tmp_path / "noise.vtu", mesh)
    again = read_vtu(tmp_path / "noise.vtu")
    assert again.sides == mesh.sides == frame.sides
    least = again.measurement.smallest_scaled_jacobian
    assert PINCH_TEMPLATES.allows(least, again)
    assert least < 1.1 * PINCH_TEMPLATES.bound_of(again)
    save_fractions(tmp_path / "noise.npz", noise)
    assert load_fractions(tmp_path / "noise.npz").grid == grid
    points = rng.normal(size=(5, dim))
    assert grid.to_points(grid.to_lattice(points)) == pytest.approx(points)


def test_what_cannot_be_turned_or_stretched_is_refused():
    points, faces = torus()
    ring = (points, faces)
    for rotate, message in (
        ((1, 0, 0, 0, 1, 0, 0, 0, 2), "is not a rotation"),
        ((1, 0, 0, 0, 1, 0, 0, 0, -1), "is not a rotation: it mirrors"),
        ((30, 20), "has 2 numbers"),
    ):
        with pytest.raises(SamplingError, match=message):
            tusqh.mesh(ring, cells=8, rotate=rotate)
    with pytest.raises(ConfigError, match="`rotate` and `align`"):
        tusqh.mesh(ring, cells=8, rotate=ANGLES, align="faces")
    with pytest.raises(ConfigError, match="`window` and a grid that is turned"):
        tusqh.mesh(ring, cells=8, rotate=ANGLES, window=[(0, 0, 0), (1, 1, 1)])
    for options in ({"fit": True}, {"coarsen": "interior"}, {"inside": "envelope"}):
        with pytest.raises(ConfigError, match="`cell_size` of 3 numbers"):
            tusqh.mesh(ring, cell_size=(0.2, 0.2, 0.1), **options)
    with pytest.raises(SamplingError, match=r"`grid\.cell_size` has 2 numbers"):
        tusqh.mesh(ring, cell_size=(0.2, 0.2))
    with pytest.raises(SamplingError, match="for an image"):
        tusqh.mesh(np.ones((4, 4, 4)), cell_size=(1, 1, 2), image={"full": 1.0})
    ball = trimesh.creation.icosphere(subdivisions=3)
    ball = (ball.vertices, ball.faces)
    with pytest.raises(SamplingError, match="second moments"):
        tusqh.mesh(ball, cells=8, align="principal")
    with pytest.raises(SamplingError, match="no direction has faces"):
        tusqh.mesh(ball, cells=8, align="faces")


def test_places_of_wishes_are_in_the_model(tmp_path):
    points, faces = torus()
    turned = points @ rotation().T
    wish = [{"near": [0.0, 0.0, 0.0], "class": "hole", "do": "fill"}]
    result = tusqh.mesh((turned, faces), cells=12, rotate=ANGLES, features=wish)
    assert tuple(result.report.measured) == (1, 0, 0)
