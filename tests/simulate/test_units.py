"""A model has the same physical results for every unit of length."""

import dataclasses

import numpy as np
import pytest
from plain_meshes import two_islands, unit_cube, unit_square

from tusqh.geometry.units import METRES
from tusqh.settings.simulation import Simulation
from tusqh.simulate.diffusion import simulate_diffusion

STEPS = (0, 3, 6)


def rescaled(mesh, factor):
    return dataclasses.replace(mesh, points=mesh.points * factor)


@pytest.mark.parametrize("unit", ["mm", "km", "in"])
@pytest.mark.parametrize("mesh", [two_islands(), unit_cube(4)], ids=["2D", "3D"])
@pytest.mark.parametrize("is_given", [True, False], ids=["given", "defaults"])
def test_a_model_in_another_unit_has_the_same_results(mesh, unit, is_given):
    per_metre = 1 / METRES[unit]
    place = [0.5] * mesh.dim
    given, scaled = Simulation(), Simulation()
    if is_given:
        given = Simulation(place, 0.4, 5.0, diffusivity=0.3, time_step=0.01)
        scaled = dataclasses.replace(
            given, source=[per_metre * x for x in place], radius=0.4 * per_metre
        )
    in_metres = simulate_diffusion(mesh, given, unit="m", steps=STEPS)
    other = simulate_diffusion(rescaled(mesh, per_metre), scaled, unit=unit, steps=STEPS)
    assert other.fields == pytest.approx(in_metres.fields, rel=1e-8, abs=1e-8)
    assert other.points == pytest.approx(in_metres.points * per_metre)
    numbers = in_metres.table.select_dtypes("number")
    assert other.table[numbers.columns].to_numpy() == pytest.approx(
        numbers.to_numpy(), rel=1e-8, abs=1e-10
    )
    for column in ("amount_unit", "concentration_unit"):
        assert other.table[column].tolist() == in_metres.table[column].tolist()


def test_the_amount_is_the_integral_of_the_concentration_in_si_units():
    plate = rescaled(unit_square(4), 1000.0)  # 1 m wide, in mm
    table = simulate_diffusion(
        plate, Simulation(time_step=0.1, amount=7.0), unit="mm", steps=(0, 50)
    ).table
    assert table["amount"].to_numpy() == pytest.approx(7.0)
    assert table["amount_unit"].tolist() == ["kg", "kg"]
    # In the end 7 kg are spread evenly over one square metre.
    assert table["concentration_max"].iloc[-1] == pytest.approx(7.0)
    assert table["concentration_unit"].iloc[-1] == "kg/m^2"


def test_a_model_without_a_known_unit_keeps_its_own():
    known = simulate_diffusion(unit_cube(3), unit="m", steps=STEPS)
    unknown = simulate_diffusion(unit_cube(3), unit="px", steps=STEPS)
    assert np.array_equal(known.fields, unknown.fields)
    assert set(unknown.table["concentration_unit"]) == {"J/px^3"}


def test_the_default_time_lets_the_release_spread_but_not_vanish():
    """The time step follows from the size, so a part of 50 mm is drawn like a part of 50 m."""
    part = rescaled(unit_cube(10), 50.0)
    table = simulate_diffusion(part, unit="mm").table
    largest = table["concentration_max"].to_numpy()
    even = 1000.0 / 0.05**3
    assert (np.diff(largest) < 0).all()
    assert largest[0] > 2 * even
    assert table["time_s"].iloc[-1] == pytest.approx(0.05**2 / 36 / 1e-5)
