"""Estimate the memory that sampling and meshing need, before any work."""

from __future__ import annotations

import math
from typing import Literal

from tusqh.errors import SamplingError
from tusqh.grid import BackgroundGrid
from tusqh.machine import available_memory

#: Bytes of memory for each cell of the grid and for each kept cell, by dimension: the peak of
#: `tusqh.mesh` at a threshold, beyond what the imported program has.  In the plane the check for
#: overlaps needs most of it.  Measured on bunny, cube, shell and disc; a test repeats it.
_MESHING = {2: (20, 900), 3: (40, 184)}

#: Bytes that a mesh in slabs of any size needs, with the libraries that read its pieces.
_LEAST_OF_SLABS = 250_000_000

#: Bytes for each cell of the grid that slabs need for the contacts of all cells, and for each cell
#: of the grid and each kept cell in one slab.
_SLABS = (20, 30, 150)

#: Bytes that a mesh of any size needs.
_LEAST = 45_000_000

#: Bytes for each cell of a grid full of several materials.
_SEVERAL = {2: 1000, 3: 500}

#: Bytes for each cell of the grid for sampling alone.
_SAMPLING = {2: 24, 3: 40}


def estimate_memory(n_cells: int, n_kept: int, *, dim: int) -> int:
    """Return the memory in bytes that `tusqh.mesh` needs at its peak.

    Parameters
    ----------
    n_cells
        Cells of the background grid.
    n_kept
        Cells of the mesh, without templates.
    dim
        Dimension of the grid.

    Examples
    --------
    >>> round(estimate_memory(256**3, 256**3 // 4, dim=3) / 1e9, 1)
    1.5
    """
    per_cell, per_kept = _MESHING[dim]
    return _LEAST + n_cells * per_cell + n_kept * per_kept


def estimate_slabs(n_cells: int, n_kept: int, n_slabs: int) -> int:
    """Return the memory in bytes that a mesh in slabs needs at its peak.

    Parameters
    ----------
    n_cells
        Cells of the background grid.
    n_kept
        Cells of the mesh, without templates.
    n_slabs
        Number of slabs.

    Examples
    --------
    >>> round(estimate_slabs(512**3, 512**3 // 4, 8) / 1e9, 1)
    4.1
    """
    return n_cells * _SLABS[0] + estimate_slab(n_cells, n_kept, n_slabs)


def estimate_slab(n_cells: int, n_kept: int, n_slabs: int) -> int:
    """Return the memory in bytes that one of several slabs needs alone, as a job of its own.

    Parameters
    ----------
    n_cells, n_kept, n_slabs
        See `estimate_slabs`.

    Examples
    --------
    >>> round(estimate_slab(512**3, 512**3 // 4, 8) / 1e9, 1)
    1.4
    """
    _, per_cell_of_slab, per_kept = _SLABS
    return _LEAST_OF_SLABS + (n_cells * per_cell_of_slab + n_kept * per_kept) // n_slabs


def require_memory(
    grid: BackgroundGrid,
    step: Literal["sampling", "meshing", "meshing of several materials"],
    *,
    name: str,
    volume: float | None = None,
) -> None:
    """Raise a `SamplingError` with an estimate if a grid cannot fit in this machine's memory.

    Parameters
    ----------
    grid
        The background grid.
    step
        The step that needs the memory.
    name
        The model, for the message.
    volume
        About the volume (2D: area) of the mesh, in model units; None: that of the whole grid.

    Raises
    ------
    SamplingError
        The estimate exceeds the memory of this machine.
    """
    needed = grid.n_cells * _SAMPLING[grid.dim]
    if step == "meshing of several materials":
        needed = grid.n_cells * _SEVERAL[grid.dim]
    elif step == "meshing":
        full = grid.n_cells if volume is None else int(abs(volume) / grid.cell_size**grid.dim)
        needed = estimate_memory(grid.n_cells, min(full, grid.n_cells), dim=grid.dim)
    available = available_memory()
    if needed > available:
        slabs = (
            "`--slabs auto`, which makes the same mesh in pieces, "
            if step == "meshing" and grid.dim == 3
            else ""
        )
        coarser = math.ceil(20 * (needed / available) ** (1 / grid.dim)) / 20
        raise SamplingError(
            f"{step} on the {grid.label} grid of {grid.n_cells:,} cells needs about "
            f"{needed / 1e9:.3g} GB",
            where=name,
            expected=f"at most the {available / 1e9:.3g} GB that this machine has left",
            remedy=f"use {slabs}cells at least {coarser:g} times as large (`grid.cell_size`), "
            "fewer `grid.cells`, or a `window` around a part of the geometry",
        )
