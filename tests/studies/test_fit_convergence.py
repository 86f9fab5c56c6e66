"""Distances of fitted boundaries over the size of the cells."""

import numpy as np
import pandas as pd
import pytest

from studies.fit_convergence import _torus, _volume, find_orders, measure_convergence


def test_orders_are_slopes():
    size = np.array([0.25, 0.125, 0.0625])
    distances = {"at_points": 3 * size**2, "at_facets": size**2, "from_surface": 0.1 * size}
    table = pd.DataFrame({"surface": "sphere", "cell_size": size, **distances})
    table["max_distance"] = 7.0
    orders = find_orders(table).iloc[0]
    assert orders[[*distances, "max_distance"]].tolist() == pytest.approx([2, 2, 1, 0], abs=1e-9)


def test_the_torus_has_its_volume():
    assert _volume(*_torus()) == pytest.approx(2 * np.pi**2 * 0.45**2, rel=2e-3)


@pytest.mark.slow
def test_the_distance_of_a_sphere_falls_faster_than_the_cell():
    table = measure_convergence(["sphere"], [8, 16])
    assert find_orders(table).iloc[0]["at_facets"] > 1.3
    assert (table["volume_error"].abs() < [0.02, 0.01]).all()
