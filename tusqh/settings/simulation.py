"""The settings of the simulation: what is released into a mesh, and how it spreads."""

from __future__ import annotations

from dataclasses import dataclass

from tusqh.settings.field import setting
from tusqh.settings.section import Section

#: Default diffusivity by dimension, in m^2/s: a contaminant in turbulent water, and heat in steel.
DIFFUSIVITY = {2: 1.0, 3: 1e-5}


@dataclass(frozen=True)
class Simulation(Section):
    """The release of a contaminant (in 3D, of heat) at a point, and its diffusion.

    Lengths are in the model's unit, everything else is in SI units.  If the model's unit is not in
    `tusqh.geometry.units.METRES`, it replaces every metre.
    """

    source: tuple[float, ...] | None = setting(
        "Where the amount is released, `[x, y]` or `[x, y, z]`.",
        default=None,
        otherwise="farthest from the boundary",
        unit="the model's `unit`",
        n_items=(2, 3),
    )
    radius: float | None = setting(
        "Standard deviation of the Gaussian release.",
        default=None,
        otherwise="two cells",
        unit="the model's `unit`",
        above=0,
    )
    amount: float = setting(
        "Released mass; in 3D, released heat. With heat, the field is temperature times heat "
        "capacity.",
        default=1000.0,
        unit="kg; in 3D J",
        above=0,
    )
    diffusivity: float | None = setting(
        "Diffusivity. The defaults suit a contaminant in turbulent water, and heat in steel.",
        default=None,
        otherwise="1; in 3D 1e-5",
        unit="m²/s",
        above=0,
    )
    time_step: float | None = setting(
        "Time step. With the default, the release spreads a third of the way across the mesh.",
        default=None,
        otherwise="from the size of the mesh",
        unit="s",
        above=0,
    )
    refinements: int = setting(
        "Number of uniform refinements of the mesh before the simulation.",
        default=0,
        at_least=0,
        at_most=4,
    )
