"""What is released into a mesh, and how it spreads."""

from __future__ import annotations

from dataclasses import dataclass

from tusqh.settings.field import setting
from tusqh.settings.section import Section


@dataclass(frozen=True)
class Simulation(Section):
    """The release of a contaminant (in 3D of heat) at a point, and its diffusion."""

    source: tuple[float, ...] | None = setting(
        "Where it is released, `[x, y]` or `[x, y, z]`.",
        default=None,
        otherwise="farthest from the boundary",
        unit="units of the geometry",
        n_items=(2, 3),
    )
    radius: float | None = setting(
        "Standard deviation of the release.",
        default=None,
        otherwise="two cells",
        unit="units of the geometry",
        above=0,
    )
    amount: float = setting(
        "Released mass; in 3D, released heat. With heat, the field is temperature times heat "
        "capacity.",
        default=1000.0,
        unit="kg, in 3D J",
        above=0,
    )
    diffusivity: float = setting("Diffusivity.", default=1.0, unit="m^2/s", above=0)
    time_step: float | None = setting(
        "Time step.",
        default=None,
        otherwise="such that the release spreads a third of the way across the mesh",
        unit="s",
        above=0,
    )
    refinements: int = setting(
        "Uniform refinements of the mesh before the simulation.", default=0, at_least=0, at_most=4
    )
