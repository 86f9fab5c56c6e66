"""Units of length and the units of simulated quantities.

Geometry is in the unit that its file or its model states; a simulation is in SI units.  A model
whose unit is not in `tusqh.geometry.units.METRES` is simulated and labelled in its own unit.
"""

from __future__ import annotations

from tusqh.geometry.units import metres_in


def simulated_length(unit: str) -> tuple[float, str]:
    """Return the factor from a model's unit to the simulation's unit, and that unit.

    Parameters
    ----------
    unit
        The model's unit of length.

    Returns
    -------
    factor : float
        A length in the model's unit times this factor is a length in the simulation's unit.
    simulated : str
        ``"m"`` if the size of the model's unit is known, otherwise the model's unit.

    Examples
    --------
    >>> simulated_length("mm"), simulated_length("px")
    ((0.001, 'm'), (1.0, 'px'))
    """
    size = metres_in(unit)
    return (1.0, unit) if size is None else (size, "m")


def amount_unit(dim: int) -> str:
    """Return the unit of the released amount: kg of a contaminant in 2D, J of heat in 3D.

    Parameters
    ----------
    dim
        Dimension of the mesh, 2 or 3.
    """
    return "kg" if dim == 2 else "J"


def concentration_unit(dim: int, unit: str) -> str:
    """Return the unit of the simulated field for a model's unit of length.

    Parameters
    ----------
    dim
        Dimension of the mesh, 2 or 3.
    unit
        The model's unit of length.

    Examples
    --------
    >>> concentration_unit(2, "mm"), concentration_unit(3, "km"), concentration_unit(3, "px")
    ('kg/m^2', 'J/m^3', 'J/px^3')
    """
    return f"{amount_unit(dim)}/{simulated_length(unit)[1]}^{dim}"
