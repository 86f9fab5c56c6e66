"""Solids with known creases, and how well fitted meshes hold them."""

import numpy as np
import pytest

from studies.creases import measure_creases
from studies.methods.creased_solids import SOLIDS
from tusqh.sampling.winding_tree import plant, wind_beside


def is_inside(solid, places):
    tree = plant(solid.points[solid.triangles])
    return wind_beside(tree, places, np.full(places.shape, 1e-7))[:, 0] >= 0.5


@pytest.mark.parametrize("name", SOLIDS)
def test_creases_are_where_the_winding_number_bends(name):
    """On a small circle around a crease, the inside is one arc that is not a half."""
    solid = SOLIDS[name][0]().turned(3)
    chosen = solid.creases[np.linalg.norm(np.diff(solid.creases, axis=1)[:, 0], axis=1) > 0.06]
    chosen = chosen[:: max(1, len(chosen) // 25)]
    turns = 2 * np.pi * (np.arange(96) + 0.5) / 96
    for start, end in chosen:
        along = (end - start) / np.linalg.norm(end - start)
        one = np.cross(along, np.eye(3)[np.abs(along).argmin()])
        one /= np.linalg.norm(one)
        around = np.outer(np.cos(turns), one) + np.outer(np.sin(turns), np.cross(along, one))
        inside = is_inside(solid, 0.5137 * start + 0.4863 * end + 0.004 * around)
        assert (inside != np.roll(inside, 1)).sum() == 2
        assert abs(inside.sum() - 48) > 96 * 35 / 360


@pytest.mark.parametrize(
    ("name", "length", "corners"),
    [
        ("cube", 12, 8),
        ("cylinder", 4 * np.pi, 0),
        ("plate", 2 * (12.8 + 4 + 1.2 * np.pi) + 8, 16),
        ("two_boxes", 47.2, 20),
        ("bracket", 2 * 14.4 + 18, 12),
    ],
)
def test_creases_have_the_length_and_the_corners_of_the_solid(name, length, corners):
    solid = SOLIDS[name][0]()
    found = np.linalg.norm(np.diff(solid.creases, axis=1), axis=2).sum()
    assert found == pytest.approx(length, rel=2e-3)
    assert len(solid.corners) == corners


def test_a_gear_has_four_edges_and_eight_corners_a_tooth():
    solid = SOLIDS["gear"][0]()
    upright = np.ptp(solid.creases[:, :, 2], axis=1) > 0
    assert upright.sum() == 40
    assert len(solid.corners) == 80


def require_held(row):
    assert row["captured"] >= 0.99
    assert row["path_mean"] <= 0.05
    assert row["path_max"] <= 0.15
    assert np.isnan(row["corner_max"]) or row["corner_max"] <= 0.1
    assert row["min_scaled_jacobian"] >= 0.3


def test_the_creases_of_a_turned_cube_are_held():
    require_held(measure_creases(["cube"], [0]).iloc[0])
