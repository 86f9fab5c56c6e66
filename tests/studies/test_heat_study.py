"""The heat problem on staircases and on fitted meshes."""

import numpy as np
import pytest

from studies.heat import fit_orders, measure_heat, unit_sphere
from tusqh.geometry.soup import Soup
from tusqh.sampling.reference import signed_volume


def test_the_error_falls_faster_on_fitted_meshes():
    table = measure_heat([8, 16, 32], [])
    orders = fit_orders(table).set_index("boundary")["temperature_order"]
    assert orders["fitted"] > 1.5 > 1.3 > orders["staircase"]
    worst = table.set_index(["boundary", "cells"])["temperature_error"]
    for cells in (8, 16, 32):
        assert worst["fitted", cells] < worst["staircase", cells] / 5


def test_orders_are_slopes():
    table = measure_heat([8, 16], [])
    table.loc[:, "temperature_error"] = 3 * table["cell_size"] ** 2
    table.loc[:, "heat_error"] = -0.1 * table["cell_size"]
    orders = fit_orders(table)
    assert orders["temperature_order"].tolist() == pytest.approx([2, 2])
    assert orders["heat_order"].tolist() == pytest.approx([1, 1])


def test_the_sphere_is_closed_and_points_outwards():
    points, triangles = unit_sphere(40)
    assert np.allclose(np.linalg.norm(points, axis=1), 1)
    volume = signed_volume(Soup(points, triangles, np.zeros(len(triangles), dtype=np.int64)))
    assert volume == pytest.approx(4 * np.pi / 3, rel=0.02)
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
