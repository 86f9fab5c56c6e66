"""Choose units for axes and tables."""

from __future__ import annotations


def length_scale(extent: float, unit: str) -> tuple[float, str]:
    """Return the unit for the axes of a drawing.

    Parameters
    ----------
    extent
        Longest side of the drawing, in the model's unit.
    unit
        The model's unit of length.

    Returns
    -------
    scale : float
        Divisor of lengths.
    unit : str
        Unit of the divided lengths.

    Examples
    --------
    >>> length_scale(250_000.0, "m")
    (1000.0, 'km')
    """
    return (1000.0, "km") if unit == "m" and extent >= 10_000 else (1.0, unit)
