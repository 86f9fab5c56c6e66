"""The settings of a simulation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

#: Diffusivity by dimension where none is given, m^2/s: a contaminant in turbulent water, and heat
#: in steel.
DIFFUSIVITY = {2: 1.0, 3: 1e-5}


@dataclass(frozen=True)
class Simulation:
    """The release of a contaminant (in 3D, of heat) and its diffusion.

    Lengths are in the model's unit, everything else is in SI units.  For a model whose unit is not
    in `tusqh.simulate.units.METRES` read that unit for every metre.

    Parameters
    ----------
    source
        Where the amount is released, shape (dim,), in the model's unit; None: the centre of the
        element farthest from the boundary.
    radius
        Standard deviation of the Gaussian release, in the model's unit; None: twice the longest
        element side.
    amount
        Released mass, in kg; in 3D released heat, in J.
    diffusivity
        Diffusivity, in m^2/s; None: `DIFFUSIVITY`.
    time_step
        In s; None: the last step reaches a spread ``sqrt(4 D t)`` of a third of the mesh's longest
        side, whatever its size.
    refinements
        Uniform refinements of the mesh before the simulation.
    """

    source: Sequence[float] | None = None
    radius: float | None = None
    amount: float = 1000.0
    diffusivity: float | None = None
    time_step: float | None = None
    refinements: int = 0
