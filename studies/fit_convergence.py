"""Measure how the distance of fitted boundaries from smooth surfaces falls with the cell."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

import tusqh
from studies.heat import unit_sphere
from studies.methods.creased_solids import SOLIDS
from tusqh.grid import FloatArray, IntArray

#: Radii of the torus.
_LARGE, _SMALL = 1.0, 0.45


def measure_convergence(names: Sequence[str], cells: Sequence[int]) -> pd.DataFrame:
    """Return the distances of fitted boundaries from surfaces, on several grids.

    Parameters
    ----------
    names
        Surfaces: ``"sphere"``, ``"torus"`` and ``"box"``, a turned one.
    cells
        Cells along the longest side.

    Returns
    -------
    table
        One row for each surface and grid: `surface`, `cells`, `cell_size`, `elements`, the mean
        distances `at_points`, `at_facets` (in their middle) and `from_surface` in model units,
        `max_distance` of these, `volume_error` relative to the triangles, and
        `min_scaled_jacobian`.
    """
    make = {"sphere": unit_sphere, "torus": _torus, "box": _box}
    rows = []
    for name in names:
        surface = make[name]()
        for n in cells:
            result = tusqh.mesh(surface, cells=n, placement="corner", fit=True, name=name)
            assert isinstance(result, tusqh.Result)
            assert result.fit is not None
            found = result.fit.fitted.distances
            is_mine = (found["unit"] == "model") & found["from"].isin(["boundary", "surface"])
            found = found[is_mine].set_index("at")
            rows.append(
                {
                    "surface": name,
                    "cells": n,
                    "cell_size": result.fractions.grid.cell_size,
                    "elements": result.mesh.n_cells,
                    "at_points": found.loc["vertices", "mean"],
                    "at_facets": found.loc["faces", "mean"],
                    "from_surface": found.loc["samples", "mean"],
                    "max_distance": found["max"].max(),
                    "volume_error": result.mesh.measurement.volume / _volume(*surface) - 1,
                    "min_scaled_jacobian": result.mesh.jacobians.scaled.min(),
                }
            )
    return pd.DataFrame(rows)


def find_orders(table: pd.DataFrame) -> pd.DataFrame:
    """Return the orders at which distances fall: slopes of their logarithms over that of the cell.

    Parameters
    ----------
    table
        See `measure_convergence`.

    Returns
    -------
    orders
        One row for each surface, with columns named like those of the distances.
    """
    measured = ("at_points", "at_facets", "from_surface", "max_distance")
    rows = []
    for surface, group in table.groupby("surface", sort=False):
        size = np.log(group["cell_size"])
        slopes = {name: np.polyfit(size, np.log(group[name]), 1)[0] for name in measured}
        rows.append({"surface": surface, **slopes})
    return pd.DataFrame(rows)


def _volume(points: FloatArray, triangles: IntArray) -> float:
    """Return the volume that closed triangles enclose."""
    a, b, c = points[triangles].transpose(1, 0, 2)
    return abs(float(np.einsum("tk,tk->t", a, np.cross(b, c)).sum())) / 6


def _box() -> tuple[FloatArray, IntArray]:
    solid = SOLIDS["cube"][0]().turned(2)
    return solid.points, solid.triangles


def _torus(n: int = 240, m: int = 120) -> tuple[FloatArray, IntArray]:
    """Return the points and triangles of a torus, n around its axis and m around its tube."""
    around, tube = np.meshgrid(
        2 * np.pi * np.arange(n) / n, 2 * np.pi * np.arange(m) / m, indexing="ij"
    )
    out = _LARGE + _SMALL * np.cos(tube)
    places = [out * np.cos(around), out * np.sin(around), _SMALL * np.sin(tube)]
    i, j = np.meshgrid(np.arange(n), np.arange(m), indexing="ij")
    a, b = (i * m + j).ravel(), ((i + 1) % n * m + j).ravel()
    c, d = ((i + 1) % n * m + (j + 1) % m).ravel(), (i * m + (j + 1) % m).ravel()
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return np.stack(places, axis=-1).reshape(-1, 3), triangles.astype(np.int64)
