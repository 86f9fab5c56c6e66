"""The size of the ball of an envelope and the thickness of a shell, in model units."""

from __future__ import annotations

from dataclasses import replace

from tusqh.errors import SamplingError
from tusqh.geometry.kinds import Surface
from tusqh.geometry.units import METRES, metres_in, unit_name
from tusqh.sampling.lattice import Box
from tusqh.settings.grid import Grid
from tusqh.settings.length_text import CELLS, split_length
from tusqh.settings.sampling import Sampling

#: In cells, if they are not given.
_SEAL, _THICKNESS = 0.5, 1.0
#: Thinner shells have no fraction that a mesh could keep, in cells.
_THINNEST = 0.25


def seal_of(geometry: Surface, sampling: Sampling, cell_size: float) -> float:
    """Return the diameter of the ball that makes an envelope, in model units.

    Parameters
    ----------
    geometry
        The geometry.
    sampling
        The settings.
    cell_size
        Edge length of a cell, in model units.

    Raises
    ------
    SamplingError
        The ball is as large as the geometry, or a unit of length is not known.
    """
    seal = _in_model_units(sampling.seal, _SEAL, "seal", geometry, cell_size)
    longest = _longest_side(geometry)
    if seal >= longest:
        raise SamplingError(
            f"a seal of {seal:.3g}, and the longest side of the geometry is {longest:.3g}",
            where="seal",
            expected="a ball smaller than the geometry: a larger one makes it a single block",
            remedy="use a length a little above the widest gap that must be closed, such as "
            f"`--seal {cell_size:.3g}` for one cell",
        )
    return seal


def thickness_of(geometry: Surface, sampling: Sampling, cell_size: float) -> float:
    """Return the thickness of a shell, in model units.

    Parameters
    ----------
    geometry
        The geometry.
    sampling
        The settings.
    cell_size
        Edge length of a cell, in model units.

    Raises
    ------
    SamplingError
        The shell is thinner than a quarter of a cell, or a unit of length is not known.
    """
    thickness = _in_model_units(sampling.thickness, _THICKNESS, "thickness", geometry, cell_size)
    if thickness < _THINNEST * cell_size * (1 - 1e-9):
        raise SamplingError(
            f"a thickness of {thickness:.3g}, and the cells are {cell_size:.3g} wide",
            where="thickness",
            expected="at least a quarter of a cell; of a thinner shell nothing is kept",
            remedy=f"use `--thickness {cell_size:.3g}`, or `--cell-size {thickness:.3g}`, which "
            "puts one cell across",
        )
    return thickness


def box_of_inside(geometry: Surface, box: Box, sampling: Sampling, grid: Grid) -> Box:
    """Return the box that the grid must cover: a shell reaches beyond the surface.

    Parameters
    ----------
    geometry
        The geometry.
    box
        Its bounding box, in model units.
    sampling
        What is inside.
    grid
        The cells, along the longest side of the box that is returned, or their size.

    Raises
    ------
    SamplingError
        The grid is to be snapped to faces that are in the middle of a shell.

    Examples
    --------
    A line of length 6 becomes a shell of 7 by 1, with 7 cells along its longest side:

    >>> from tusqh.geometry.outline import Outline
    >>> line = Outline.from_chains([[(0, 0), (6, 0)]])
    >>> box_of_inside(line, line.bounding_box(), Sampling(inside="shell"), Grid(cells=7))
    ((-0.5, -0.5), (6.5, 0.5))
    """
    if sampling.inside not in ("shell", "union"):
        return box
    if grid.snap:
        raise SamplingError(
            f"`snap` with `inside: {sampling.inside}`",
            where=geometry.name,
            expected="an inside that ends at the faces of the geometry",
            remedy="leave out `snap`: a shell has the faces in its middle; `offset` moves the grid",
        )
    sides = [b - a for a, b in zip(*box, strict=True)]
    size = grid.cell_size
    assert not isinstance(size, tuple)
    if size is None:
        # With a thickness of c cells, a side of length L has n cells of size L / (n - c).
        in_cells = _in_cells(sampling)
        cells = grid.cells if isinstance(grid.cells, tuple) else (grid.cells or 1,) * len(sides)
        size = max(side / max(n - in_cells, 0.5) for side, n in zip(sides, cells, strict=False))
    half = _in_model_units(sampling.thickness, _THICKNESS, "thickness", geometry, size) / 2
    return tuple(x - half for x in box[0]), tuple(x + half for x in box[1])


def with_lengths(geometry: Surface, sampling: Sampling, cell_size: float) -> Sampling:
    """Return the same sampling with seal and thickness as numbers, so that other cells keep them.

    Parameters
    ----------
    geometry
        The geometry.
    sampling
        What is inside.
    cell_size
        Edge length of the cell to which lengths in cells refer, in model units.

    Examples
    --------
    >>> from tusqh.geometry.outline import Outline
    >>> line = Outline.from_chains([[(0, 0), (6, 0)]])
    >>> with_lengths(line, Sampling(inside="shell"), 0.5).thickness
    0.5
    """
    if sampling.inside == "envelope":
        return replace(sampling, seal=seal_of(geometry, sampling, cell_size))
    if sampling.inside in ("shell", "union"):
        return replace(sampling, thickness=thickness_of(geometry, sampling, cell_size))
    return sampling


def _in_cells(sampling: Sampling) -> float:
    """Return a thickness that is given in cells, and 0 for others."""
    if sampling.thickness is None:
        return _THICKNESS
    if isinstance(sampling.thickness, str):
        number, unit = split_length(sampling.thickness) or (0.0, "")
        return number if unit in CELLS else 0.0
    return 0.0


def _in_model_units(
    given: float | str | None, otherwise: float, name: str, geometry: Surface, cell_size: float
) -> float:
    """Return a length that is given as a number, as text, or in cells if it is not given."""
    if given is None:
        return otherwise * cell_size
    found = (float(given), "") if not isinstance(given, str) else split_length(given)
    assert found is not None, "the settings refuse other texts"
    number, unit = found
    if unit in CELLS:
        return number * cell_size
    if not unit or unit_name(unit) == geometry.unit:
        return number
    size, own = metres_in(unit_name(unit)), metres_in(geometry.unit)
    if size is None:
        raise SamplingError(
            f"the unit {unit!r}",
            where=name,
            expected=f"a unit of length, one of {', '.join(METRES)}, or `cells`",
            remedy=f"give a number in the unit of the geometry, or `{name}: 0.5 cells`",
        )
    if own is None:
        raise SamplingError(
            f"{given}, and the unit of the geometry is not known",
            where=name,
            expected="a geometry with a unit of length",
            remedy="state the unit of the geometry, such as `--unit mm`, or give a number in it",
        )
    return number * size / own


def _longest_side(geometry: Surface) -> float:
    low, high = geometry.bounding_box()
    return max(b - a for a, b in zip(low, high, strict=True))
