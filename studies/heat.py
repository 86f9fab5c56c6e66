"""Compare the error of a heat problem on staircases and on fitted meshes of a disk and a ball.

In the disk and in the ball of radius 1, the steady temperature u of a uniform source, 0 on the
boundary, with ``-div grad u = 2 dim``, is ``1 - r^2``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from scipy.sparse.linalg import cg, spsolve

import tusqh
from tusqh.grid import FloatArray, IntArray
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.simulate.operators import assemble

#: Whether the boundary of a mesh is a staircase or fitted.
BOUNDARIES = ("staircase", "fitted")


def measure_heat(cells_2d: Sequence[int], cells_3d: Sequence[int]) -> pd.DataFrame:
    """Return the errors on meshes of a disk and of a ball, with elements of order 1.

    Parameters
    ----------
    cells_2d, cells_3d
        Cells along the diameter of the disk and of the ball.

    Returns
    -------
    table
        One row for each mesh: `domain`, `dimension`, `cells`, `cell_size` (radii), `boundary` (see
        `BOUNDARIES`), `elements`, `unknowns`, and relative errors: `temperature_error` (root of the
        mean square at the nodes), `heat_error` (of the integral of the temperature) and
        `volume_error`.
    """
    rows = []
    for domain, sizes, surface in (
        ("disk", cells_2d, _circle()),
        ("ball", cells_3d, unit_sphere()),
    ):
        for cells in sizes:
            result = tusqh.mesh(surface, cells=cells, placement="corner", fit=True, name=domain)
            assert isinstance(result, tusqh.Result)
            for boundary, mesh in zip(BOUNDARIES, (result.staircase, result.mesh), strict=True):
                row = {"domain": domain, "dimension": mesh.dim, "cells": cells}
                row |= {"cell_size": result.fractions.grid.cell_size, "boundary": boundary}
                rows.append(row | _solve(mesh))
    return pd.DataFrame(rows)


def fit_orders(table: pd.DataFrame) -> pd.DataFrame:
    """Return the orders at which errors fall: slopes of their logarithms over that of the cell.

    Parameters
    ----------
    table
        See `measure_heat`.

    Returns
    -------
    orders
        One row for each domain and boundary: `temperature_order` and `heat_order`, by least
        squares.
    """
    errors = ("temperature_error", "heat_error")
    rows = []
    for (domain, boundary), group in table.groupby(["domain", "boundary"], sort=False):
        size = np.log(group["cell_size"])
        slopes = {n: np.polyfit(size, np.log(group[n].abs()), 1)[0] for n in errors}
        orders = {name.replace("_error", "_order"): slope for name, slope in slopes.items()}
        rows.append({"domain": domain, "boundary": boundary, **orders})
    return pd.DataFrame(rows)


def _solve(mesh: VolumeMesh) -> dict[str, float]:
    """Return the size of a problem and its relative errors."""
    operators = assemble(mesh)
    exact = 1 - (operators.nodes**2).sum(axis=1)
    ones = np.ones(len(exact))
    is_free = np.ones(len(exact), dtype=bool)
    is_free[np.unique(mesh.facets.boundary)] = False
    right = (operators.mass @ (2 * mesh.dim * ones))[is_free]
    system = operators.stiffness[is_free][:, is_free].tocsc()
    found = np.zeros(len(exact))
    if mesh.dim == 2:
        found[is_free] = spsolve(system, right)
    else:
        found[is_free] = cg(system, right, rtol=1e-10)[0]
    error, weight = found - exact, operators.mass @ ones
    # Integrals over the disk and the ball of the temperature, and their sizes.
    heat, volume = (np.pi / 2, np.pi) if mesh.dim == 2 else (8 * np.pi / 15, 4 * np.pi / 3)
    size = float((weight * exact**2).sum())
    return {
        "elements": mesh.n_cells,
        "unknowns": int(is_free.sum()),
        "temperature_error": float(np.sqrt((weight * error**2).sum() / size)),
        "heat_error": float(weight @ found) / heat - 1,
        "volume_error": mesh.measurement.volume / volume - 1,
    }


def _circle(n: int = 4000) -> tuple[FloatArray, IntArray]:
    """Return the points and segments of a circle."""
    turns = np.arange(n) * (2 * np.pi / n)
    number = np.arange(n, dtype=np.int64)
    points = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    return points, np.stack([number, (number + 1) % n], axis=1)


def unit_sphere(n: int = 160) -> tuple[FloatArray, IntArray]:
    """Return a sphere of radius 1.

    Parameters
    ----------
    n
        Number of meridians, twice that of parallels.

    Returns
    -------
    points, triangles
        Points, shape (p, 3), and triangles, shape (t, 3).
    """
    down, around = np.pi * np.arange(1, n // 2) / (n // 2), 2 * np.pi * np.arange(n) / n
    rings = np.stack(
        [
            np.outer(np.sin(down), np.cos(around)),
            np.outer(np.sin(down), np.sin(around)),
            np.outer(np.cos(down), np.ones(n)),
        ],
        axis=-1,
    )
    points = np.concatenate([rings.reshape(-1, 3), [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]])
    i, j = np.meshgrid(np.arange(n // 2 - 2), np.arange(n), indexing="ij")
    a, b = (i * n + j).ravel(), (i * n + (j + 1) % n).ravel()
    c, d = a + n, b + n
    north, south = len(points) - 2, len(points) - 1
    first, last = np.arange(n), (n // 2 - 2) * n + np.arange(n)
    caps = [
        np.stack([np.full(n, north), first, np.roll(first, -1)], axis=1),
        np.stack([np.full(n, south), np.roll(last, -1), last], axis=1),
    ]
    sides = [np.stack([a, c, b], axis=1), np.stack([b, c, d], axis=1)]
    return points, np.concatenate([*caps, *sides]).astype(np.int64)
