"""Measure the suitability for analysis of raw cells, of repaired cells, and of our mesh."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from studies.methods.digital_topology import closed_betti
from studies.methods.raw_mesh import raw_mesh
from studies.methods.stiffness import (
    assemble_stiffness,
    count_kernel,
    count_mechanisms,
    element_matrices,
    estimate_condition,
    label_parts,
    points_of,
)
from studies.methods.whole_cell_repair import repair_by_cells
from tusqh.antialias.cells import CellSets
from tusqh.antialias.pinches import find_pinches
from tusqh.antialias.resolve import build_mesh
from tusqh.grid import FloatArray, IntArray
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.simulate.diffusion import march
from tusqh.simulate.operators import Operators
from tusqh.topology.betti_numbers import BettiNumbers

RAW, REPAIRED, OURS = "raw cells", "whole cells", "tusqh"
OWN_THRESHOLD = "chosen"

#: Number of time steps after which the leak is measured; the heat spreads over a third of the mesh.
_STEPS = 20


def compare_suitability(
    cell_sets: CellSets, thresholds: dict[str, float], chosen: BettiNumbers, *, name: str
) -> pd.DataFrame:
    """Return one row per threshold and scheme, which is a way to mesh the kept cells.

    Parameters
    ----------
    cell_sets
        The cells of every threshold.
    thresholds
        Thresholds by name; `OWN_THRESHOLD` is the name of the model's threshold.
    chosen
        Betti numbers for which the threshold of the model was chosen.
    name
        The model.

    Returns
    -------
    table
        `model`, `dimension`, `choice` (the threshold's name), `threshold`, `scheme`, `elements`;
        `pinches` (grid vertices; none in our mesh); `betti_0..2`, and whether they are `as_chosen`;
        `non_manifold_points`, `manifold`;
        `parts` that are joined by shared facets; `zero_modes` of the Neumann stiffness
        matrix; `mechanisms`, zero modes of elasticity beyond rigid motions; `condition` of the
        stiffness matrix, scaled by its diagonal, on its range, and the `iterations` of
        conjugate gradients (see `split_iterations`); `leak`, the share of the heat released in the
        largest part that flows into others; `min_scaled_jacobian`; `volume_error` against the
        winding-number volume; `cells_added`, `cells_removed`, `sweeps` and `ended` of the repair.
    """
    fractions = cell_sets.fractions
    volume = fractions.volume()
    rows = []
    for choice, threshold in thresholds.items():
        kept = fractions.cells >= threshold
        repair = repair_by_cells(kept, fractions.cells, threshold=threshold)
        resolved = build_mesh(cell_sets.at(threshold), fractions.grid, name=name)
        meshes = {
            RAW: raw_mesh(kept, fractions.grid, name=name),
            REPAIRED: raw_mesh(repair.kept, fractions.grid, name=name),
            OURS: resolved.mesh,
        }
        pinches = {RAW: find_pinches(kept), REPAIRED: find_pinches(repair.kept)}
        for scheme, mesh in meshes.items():
            betti = closed_betti(kept) if scheme == RAW else mesh.measurement.by_euler
            row = {
                "model": name,
                "dimension": mesh.dim,
                "choice": choice,
                "threshold": threshold,
                "scheme": scheme,
                "elements": mesh.n_cells,
                "pinches": int(pinches[scheme].sum()) if scheme in pinches else 0,
                **betti._asdict(),
                "as_chosen": betti == chosen if choice == OWN_THRESHOLD else None,
                **measure_suitability(mesh),
                "volume_error": _volume(mesh) / volume - 1,
            }
            if scheme == REPAIRED:
                row["cells_added"] = int((repair.kept & ~kept).sum())
                row["cells_removed"] = int((kept & ~repair.kept).sum())
                row["sweeps"], row["ended"] = repair.sweeps, repair.has_ended
            rows.append(row)
    table = pd.DataFrame(rows)
    counts = ["cells_added", "cells_removed", "sweeps"]
    return table.astype(dict.fromkeys(counts, "Int64"))


def split_iterations(table: pd.DataFrame) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return a table without the numbers of iterations, and a table with nothing else.

    The iterations depend on the order in which a processor's linear algebra adds numbers, and may
    differ by one from machine to machine; they are therefore in a file of their own, which is not
    compared with the lock.

    Parameters
    ----------
    table
        See `compare_suitability`.

    Returns
    -------
    suitability, iterations
        All columns but `iterations`; `model`, `choice`, `scheme` and `iterations`.
    """
    keys = ["model", "choice", "scheme"]
    return table.drop(columns="iterations"), table[[*keys, "iterations"]]


def measure_suitability(mesh: VolumeMesh) -> dict[str, Any]:
    """Return the measures of a mesh's suitability for analysis, see `compare_suitability`.

    Parameters
    ----------
    mesh
        The mesh.
    """
    n_bad = mesh.measurement.n_non_manifold
    lumped, of_elements = element_matrices(mesh)
    stiffness = assemble_stiffness(mesh, of_elements)
    condition, iterations = estimate_condition(stiffness)
    part, n_parts = label_parts(mesh)
    return {
        "non_manifold_points": n_bad,
        "manifold": n_bad == 0,
        "parts": n_parts,
        "zero_modes": count_kernel(stiffness),
        "mechanisms": count_mechanisms(mesh),
        "condition": float(f"{condition:.3g}"),
        "iterations": iterations,
        "leak": float(f"{_leak(mesh, lumped, stiffness, part):.3g}"),
        "min_scaled_jacobian": round(mesh.measurement.smallest_scaled_jacobian, 6),
    }


def _leak(mesh: VolumeMesh, lumped: FloatArray, stiffness: Any, part: IntArray) -> float:
    """Return the share of the heat of the largest part that diffuses into other parts.

    The heat starts at the points that belong to no other part.  Two parts without a common facet
    have no common area through which heat could flow, so the whole leak is an error.
    """
    volumes = mesh.volumes
    in_largest = part == np.append(np.bincount(part, weights=volumes), 0.0).argmax()
    if in_largest.all():
        return 0.0
    is_heated = points_of(mesh, in_largest) & ~points_of(mesh, ~in_largest)
    n = len(mesh.points)
    of_points = np.bincount(mesh.cells.ravel(), lumped.ravel(), n).astype(np.float64)
    of_others = np.bincount(mesh.cells[~in_largest].ravel(), lumped[~in_largest].ravel(), n)
    heat: FloatArray = is_heated.astype(np.float64)
    extent = float(np.ptp(mesh.points, axis=0).max())
    operators = Operators(None, stiffness, mesh.points, mesh.points, mesh.cells)
    (field,) = march(
        operators,
        of_points,
        heat,
        diffusivity=1.0,
        time_step=(extent / 3) ** 2 / (4 * _STEPS),
        steps=[_STEPS],
    )
    return float((of_others * field).sum() / (of_points * heat).sum())


def _volume(mesh: VolumeMesh) -> float:
    return float(mesh.volumes.sum())


def summarise_suitability(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row per scheme that summarises all meshes of `compare_suitability`.

    The columns are the number of `meshes`, of `manifold` ones, and of those with mechanisms or a
    leak; `largest_leak`; the number of meshes `as_chosen` among those at the model's own threshold
    (`chosen`); `smallest_scaled_jacobian`; the median ratio of the condition number to that of the
    raw cells; the largest volume change against the raw cells; `most_sweeps` of the repair, and
    whether all repairs ended.

    Parameters
    ----------
    table
        The concatenated tables of `compare_suitability`, without iterations.
    """
    keys = ["model", "choice"]
    volume = 1 + table.set_index(["scheme", *keys])["volume_error"]
    raw = table[table["scheme"] == RAW].set_index(keys)
    rows = []
    for scheme in (RAW, REPAIRED, OURS):
        of_scheme = table[table["scheme"] == scheme].set_index(keys)
        chosen = of_scheme.xs(OWN_THRESHOLD, level="choice")
        rows.append(
            {
                "scheme": scheme,
                "meshes": len(of_scheme),
                "manifold": int(of_scheme["manifold"].sum()),
                "with_mechanisms": int((of_scheme["mechanisms"] > 0).sum()),
                "with_leak": int((of_scheme["leak"] > 0).sum()),
                "largest_leak": float(of_scheme["leak"].max()),
                "as_chosen": int(chosen["as_chosen"].sum()),
                "chosen": len(chosen),
                "smallest_scaled_jacobian": float(of_scheme["min_scaled_jacobian"].min()),
                "median_condition_ratio": _median_ratio(of_scheme, raw, "condition"),
                "largest_volume_change": float((volume[scheme] / volume[RAW] - 1).abs().max()),
                "most_sweeps": of_scheme["sweeps"].max(),
                "all_ended": bool(of_scheme["ended"].all()) if scheme == REPAIRED else None,
            }
        )
    return pd.DataFrame(rows).astype({"most_sweeps": "Int64"})


def summarise_iterations(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row per scheme: its `meshes`, and the iterations that conjugate gradients needed.

    The columns are the `smallest`, the `median` and the `largest` number, and the `median_ratio` to
    that of the raw cells.

    Parameters
    ----------
    table
        The concatenated second tables of `split_iterations`.
    """
    keys = ["model", "choice"]
    raw = table[table["scheme"] == RAW].set_index(keys)
    rows = []
    for scheme in (RAW, REPAIRED, OURS):
        of_scheme = table[table["scheme"] == scheme].set_index(keys)
        numbers = of_scheme["iterations"]
        rows.append(
            {
                "scheme": scheme,
                "meshes": len(of_scheme),
                "smallest": int(numbers.min()),
                "median": float(numbers.median()),
                "largest": int(numbers.max()),
                "median_ratio": _median_ratio(of_scheme, raw, "iterations"),
            }
        )
    return pd.DataFrame(rows)


def _median_ratio(table: pd.DataFrame, raw: pd.DataFrame, column: str) -> float:
    return float(f"{(table[column] / raw[column]).median():.3g}")
