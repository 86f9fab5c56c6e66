"""Checks of a fitted mesh against the geometry, and the numbers that tables show of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from tusqh.antialias.scheme import Scheme
from tusqh.meshes.checks import Check

#: Fitted elements with smaller scaled Jacobians are not suitable.
FITTED = Scheme("fitted boundary", {2: 0.2, 3: 0.2}, on_sides=0.2)

#: Distances between boundary and surface without a warning, in cells.
MEAN_DISTANCE, P99_DISTANCE = 0.05, 0.2

#: Share of boundary points that may be off the surface without a warning, and of the surface that
#: may be at walls and gaps thinner than a cell.
_OFF, _UNRESOLVED = 0.05, 0.1

_REMEDY = (
    "see unfitted.csv: use smaller cells (`--cells`) where features are finer than a cell, "
    "or `--scope local` where another threshold changes the shape"
)

_FINER = "such walls and gaps are met in part: use smaller cells (`--cells`); see unfitted.csv"


def summarise_distances(distances: pd.DataFrame) -> dict[str, float | None]:
    """Return the distances in cells that tables show.

    Parameters
    ----------
    distances
        See `tusqh.fitting.fitted.Fitted`.

    Returns
    -------
    numbers
        `mean_distance`, `p99_distance` and `max_distance` of the boundary, where the vertices or
        the middles of faces, whichever are farther, count; `surface_mean_distance` of the surface
        from the boundary; `resolved_mean_distance` and `resolved_p99_distance` of the boundary
        where walls and gaps are at least a cell wide.  None if there is nothing to measure.
    """
    rows = distances[distances["unit"] == "cells"]
    sides = ("boundary", "surface", "resolved boundary")
    boundary, surface, resolved = (rows[rows["from"] == side] for side in sides)
    found = {f"{key}_distance": boundary[key].max() for key in ("mean", "p99", "max")}
    found["surface_mean_distance"] = surface["mean"].max()
    found |= {f"resolved_{key}_distance": resolved[key].max() for key in ("mean", "p99")}
    return {key: float(value) if np.isfinite(value) else None for key, value in found.items()}


def check_fit(
    distances: pd.DataFrame,
    fell_back: pd.DataFrame,
    *,
    n_boundary: int,
    cell_size: float,
    unresolved: float,
) -> list[Check]:
    """Return the checks of the distances of a fitted mesh, which are warnings.

    Distances have to be small where the grid resolves the surface; where it does not, the share of
    the surface is the warning.

    Parameters
    ----------
    distances, fell_back
        See `tusqh.fitting.fitted.Fitted`.
    n_boundary
        Number of points on the boundary of the mesh.
    cell_size
        Edge length of a cell, in model units.
    unresolved
        Share of the surface at walls and gaps thinner than a cell.
    """
    found = summarise_distances(distances)
    n_off = min(int(fell_back["points"].sum()), n_boundary)
    share = n_off / max(n_boundary, 1)
    return [
        _distance("mean", "mean", found, MEAN_DISTANCE, cell_size),
        _distance("p99", "99 %", found, P99_DISTANCE, cell_size),
        Check(
            id="unresolved",
            name="surface at walls and gaps thinner than a cell",
            found=f"{100 * unresolved:.1f} % of the surface",
            required=f"<= {100 * _UNRESOLVED:g} %",
            holds=unresolved <= _UNRESOLVED,
            is_warning=True,
            remedy="" if unresolved <= _UNRESOLVED else _FINER,
        ),
        Check(
            id="fell_back",
            name="boundary points that do not follow the surface",
            found=f"{n_off:,} of {n_boundary:,}, in {len(fell_back):,} rows",
            required=f"<= {100 * _OFF:g} %",
            holds=share <= _OFF,
            is_warning=True,
            remedy="" if share <= _OFF else _REMEDY,
        ),
    ]


def check_volume_again(
    comparison: Sequence[Check], facts: Mapping[str, Any], volume: float, tolerance: float
) -> list[Check]:
    """Return the comparison of a staircase with its geometry, with the volume of the fitted mesh.

    Parameters
    ----------
    comparison
        See `tusqh.quality.comparison.compare_with_geometry`.
    facts
        See `tusqh.pipeline.build.Built.facts`.
    volume
        Volume of the fitted mesh.
    tolerance
        Largest relative difference without a warning.
    """
    reference = facts.get("reference_volume") or 0.0
    checks = []
    for check in comparison:
        if check.id == "volume" and reference > 0:
            ratio = volume / reference
            holds = abs(ratio - 1) <= tolerance
            found = f"{ratio:.4f} of {facts['reference_source']}"
            remedy = "" if holds else check.remedy or _REMEDY
            is_warning = check.is_warning or abs(ratio - 1) <= 0.5
            check = replace(check, found=found, holds=holds, remedy=remedy, is_warning=is_warning)
        checks.append(check)
    return checks


def describe_fit(facts: Mapping[str, Any]) -> dict[str, str]:
    """Return a line on the distances of a fitted mesh, by its title; none for a staircase.

    Parameters
    ----------
    facts
        See `tusqh.pipeline.fit.Fit.facts`.

    Examples
    --------
    >>> fit = {"mean_distance": 0.01, "p99_distance": 0.1, "fell_back": 3}
    >>> describe_fit({"fit": fit})["fit"]
    'boundary 0.0100 cells from the surface (99 %: 0.100), 3 points elsewhere'
    >>> describe_fit({})
    {}
    """
    if "fit" not in facts:
        return {}
    found = facts["fit"]
    elsewhere = f"{found['fell_back']:,} points elsewhere"
    if found["mean_distance"] is None:
        return {"fit": f"no part of the boundary has a surface within reach, {elsewhere}"}
    return {
        "fit": f"boundary {found['mean_distance']:.4f} cells from the surface "
        f"(99 %: {found['p99_distance']:.3f}), {elsewhere}"
    }


def _distance(
    key: str, title: str, distances: Mapping[str, float | None], most: float, cell_size: float
) -> Check:
    """Return the check of one distance, in cells and in model units."""
    whole, found = distances[f"{key}_distance"], distances[f"resolved_{key}_distance"]
    shown = "not run: no part of the boundary has a surface within reach"
    if whole is not None:
        shown = f"{whole:.4f} cells ({whole * cell_size:.3g}) on all of the surface"
        if found is not None:
            shown = f"{found:.4f} cells ({found * cell_size:.3g}); {shown}"
    return Check(
        id=f"distance_{key}",
        name=f"distance of the boundary to the surface where the grid resolves it, {title}",
        found=shown,
        required=f"<= {most:g} cells",
        holds=None if found is None else found <= most,
        is_warning=True,
        remedy="" if found is None or found <= most else _REMEDY,
    )
