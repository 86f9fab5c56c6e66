r"""Compare steady diffusion in two materials with its exact solutions.

A *wall* of two layers with the thicknesses ``L1`` and ``L2`` has the flux ``1 / (L1 / D1 + L2 /
D2)`` per area between the values 1 and 0.  Two concentric *shells* between the radii r, s and t
have, in the plane, the flux ``2 pi / (ln(s / r) / D1 + ln(t / s) / D2)`` per length, and in space
``4 pi / ((1 / r - 1 / s) / D1 + (1 / s - 1 / t) / D2)``.  The wall follows the grid and is exact.
The boundary of the shells is a staircase, whose error falls with the size of the cells.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pandas as pd

from tusqh.contacts import MaterialFractions, MaterialMesh, mesh_materials
from tusqh.grid import BackgroundGrid, BoolArray, FloatArray, IntArray
from tusqh.meshes.regions import Regions
from tusqh.sampling.doubled_grid import combine_half_blocks
from tusqh.simulate.steady import SteadyField, solve_steady

#: Diffusivities of the first and the second layer or shell.
DIFFUSIVITIES = {"first": 1.0, "second": 10.0}

#: Diffusivity of the core inside both shells, which has one value everywhere.
CORE = {"core": 1.0}

#: Radii of the core and of the two shells.
RADII = (2.0, 3.0, 4.0)

#: Cells along the diameter of the shells, in the plane and in space.
CELLS = {2: (24, 48, 96), 3: (16, 32)}

#: Decimals of the errors.  A wall's error and every jump are rounding errors near 1e-16, which
#: differ from processor to processor; as they stand, a comparison of two runs would take them for
#: results.  Errors below half of the last decimal, 5e-13, are 0.
_DECIMALS = 12

#: Samples along each side of a half-block in the fractions of the shells.
_SAMPLES = 4


def compare_layers() -> pd.DataFrame:
    """Return a row for every wall and every size of the shells.

    The columns are `case`, `dimension`, `cells` (along the longest side), `elements`, `flux`,
    `exact`, `error` (relative), and `jump`, the relative difference of the fluxes that leave the
    first material and enter the second through their interface.  Errors and jumps are rounded to 12
    decimals, so that rounding errors are 0.
    """
    rows = [_wall(dimension) for dimension in (2, 3)]
    rows += [_shells(dimension, n) for dimension in (2, 3) for n in CELLS[dimension]]
    return pd.DataFrame(rows)


def _wall(dimension: int) -> dict[str, object]:
    """Return the row of a wall of 12 cells, of which the first layer has 5."""
    shape = (12, 4, 3)[:dimension]
    labels = np.ones(shape, dtype=np.int64)
    labels[5:] = 2
    found = mesh_materials(labels)
    found = MaterialMesh(**{**vars(found), "names": ("first", "second", "void")})
    x = found.mesh.points[:, 0]
    fixed: dict[float, IntArray] = {1.0: np.flatnonzero(x == 0), 0.0: np.flatnonzero(x == 12)}
    field = _solve(found, DIFFUSIVITIES, fixed)
    area = float(np.prod(shape[1:]))
    exact = area / (5 / DIFFUSIVITIES["first"] + 7 / DIFFUSIVITIES["second"])
    return _row("wall", found, field, exact, cells=12)


def _shells(dimension: int, n: int) -> dict[str, object]:
    """Return the row of shells on a grid with n cells along the diameter."""
    found = mesh_materials(_shell_fractions(dimension, n), name="shells")
    core = found.names.index("core")
    inner: IntArray = np.unique(found.mesh.cells[found.material == core])
    outer: IntArray = np.unique(found.mesh.boundary.corners)
    field = _solve(found, DIFFUSIVITIES | CORE, {1.0: inner, 0.0: outer})
    first, second = DIFFUSIVITIES["first"], DIFFUSIVITIES["second"]
    r, s, t = RADII
    if dimension == 2:
        exact = 2 * np.pi / (np.log(s / r) / first + np.log(t / s) / second)
    else:
        exact = 4 * np.pi / ((1 / r - 1 / s) / first + (1 / s - 1 / t) / second)
    return _row("shells", found, field, float(exact), cells=n)


def _shell_fractions(dimension: int, n: int) -> MaterialFractions:
    """Return the fractions of a core and two shells."""
    size = 2 * RADII[-1] / n
    grid = BackgroundGrid((n,) * dimension, size, (-RADII[-1],) * dimension)
    along = (np.arange(2 * n * _SAMPLES) + 0.5) * size / (2 * _SAMPLES) - RADII[-1]
    squared = np.sum(np.meshgrid(*[along**2] * dimension, indexing="ij"), axis=0)
    inside = [_mean((squared < r**2) & (squared >= s**2)) for s, r in pairwise((0, *RADII))]
    multiples = [combine_half_blocks(means) for means in inside]
    return MaterialFractions.from_multiples(grid, ["core", "first", "second"], multiples)


def _mean(samples: BoolArray) -> FloatArray:
    """Return means over half-blocks."""
    n = samples.shape[0] // _SAMPLES
    blocks = samples.reshape([k for _ in range(samples.ndim) for k in (n, _SAMPLES)])
    return np.asarray(blocks.mean(axis=tuple(range(1, 2 * samples.ndim, 2))))


def _solve(
    found: MaterialMesh, diffusivities: dict[str, float], fixed: dict[float, IntArray]
) -> SteadyField:
    """Return the steady field on a mesh."""
    return solve_steady(found.mesh, Regions(found.names, found.material), diffusivities, fixed)


def _row(
    case: str, found: MaterialMesh, field: SteadyField, exact: float, *, cells: int
) -> dict[str, object]:
    """Return the fluxes through the interface of both layers beside the exact one."""
    between = np.unique(found.interfaces["first", "second"].facets)
    leaves, enters = field.flux_from("first", between), -field.flux_from("second", between)
    return {
        "case": case,
        "dimension": found.mesh.dim,
        "cells": cells,
        "elements": found.mesh.n_cells,
        "flux": leaves,
        "exact": exact,
        "error": round(abs(leaves / exact - 1), _DECIMALS),
        "jump": round(abs(leaves - enters) / exact, _DECIMALS),
    }
