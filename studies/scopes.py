"""Compare the two scopes on every model: one threshold for the whole model, and local changes.

Models that have few topologies at any threshold also get the cheapest single features, opened, cut
or filled, which only local changes can do.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from tusqh.fitting.distances import measure_distances
from tusqh.fitting.of_geometry import target_of
from tusqh.fitting.target import Target as Surface
from tusqh.geometry.kinds import Geometry
from tusqh.grid import BoolArray
from tusqh.local_topology.features import Features
from tusqh.local_topology.prices import affordable_rows, tabulate_prices
from tusqh.sampling.lattice import Box
from tusqh.settings.features import Feature
from tusqh.settings.goal import Goal, Scope, Target
from tusqh.settings.sampling import Sampling
from tusqh.threshold.choose import choose_threshold
from tusqh.threshold.goals import matches
from tusqh.threshold.plateaus import BETTI, Plateaus, merge_intervals
from tusqh.threshold.selection import Selection
from tusqh.topology.betti_numbers import BettiNumbers

#: The base of the local scope, to which both scopes are compared.
BASE = 0.5

#: Largest number of targets of a model.
MOST_TARGETS = 3

#: The scopes, in the order of the rows.
SCOPES: tuple[Scope, ...] = ("global", "local")


def compare_scopes(
    plateaus: Plateaus,
    geometry: Geometry,
    *,
    wanted: Target | None = None,
    sampling: Sampling | None = None,
    window: Box | None = None,
    name: str,
) -> pd.DataFrame:
    """Return the meshes of both scopes for some targets of a model.

    Parameters
    ----------
    plateaus
        The plateaus of the threshold.
    geometry
        The geometry, for the distances.
    wanted
        The target of the model's configuration, if it has one.
    sampling, window
        How the geometry was sampled, and the box to mesh in.
    name
        The model.

    Returns
    -------
    table
        One row per target and scope: `model`, `dimension`, `grid`; `base_betti`, the Betti numbers
        at 1/2; `target`, and whether it is the `configured` one; `scope`; `threshold`, in the local
        scope that of the seed; `cells_changed`, the number of cells that differ from those of 1/2,
        and how many fewer these are than with the global scope (`cells_saved`, missing for a
        feature, which one threshold does not change by itself);
        the volume of the mesh over that of the geometry (`volume_ratio`) and of the kept cells over
        those at 1/2 (`volume_over_base`); `betti_measured`; whether the mesh is sound and both
        measurements confirm the target (`holds`); the mean distances in cells from the boundary to
        the surface and back (`boundary_mean`, `surface_mean`; missing for images).
    """
    fractions = plateaus.cell_sets.fractions
    base = plateaus.cell_sets.at(BASE)
    surface = target_of(geometry, fractions, sampling=sampling, sides=window)
    rows = []
    targets = pick_targets(plateaus.table, base.predicted, wanted)
    goals = [
        (str(target), target, Goal(target=target, scope=scope, base=BASE))
        for target in targets
        for scope in SCOPES
    ]
    goals += pick_features(plateaus, MOST_TARGETS - len(targets))
    for text, target, goal in goals:
        selection, _ = choose_threshold(plateaus, goal, name=name)
        rows.append(
            {
                "model": name,
                "dimension": fractions.grid.dim,
                "grid": fractions.grid.label,
                "base_betti": str(base.predicted),
                "target": text,
                "configured": target == wanted,
                "scope": goal.scope or "local",
                "threshold": selection.threshold,
                **_measure(selection, target, base.kept, plateaus.reference.volume),
                **_distances(selection, surface),
            }
        )
    table = pd.DataFrame(rows)
    of_global = table["cells_changed"].where(table["scope"] == "global")
    of_global = of_global.groupby(table["target"]).transform("first")
    table.insert(9, "cells_saved", (of_global - table["cells_changed"]).astype("Int64"))
    return table


def pick_features(plateaus: Plateaus, n: int) -> list[tuple[str, Target, Goal]]:
    """Return the features of the base that change the fewest cells, opened, cut or filled.

    Parameters
    ----------
    plateaus
        The plateaus of the threshold.
    n
        Largest number of features.

    Returns
    -------
    wishes
        The wish in words, the Betti numbers that the mesh must have, and the goal.
    """
    if n < 1:
        return []
    features = Features(plateaus.cell_sets, BASE)
    prices = tabulate_prices(features, affordable_rows(features))
    cheap = prices[prices["possible"]].sort_values("cells", kind="stable").head(n)
    found = []
    for price in cheap.to_dict("records"):
        after = np.add(features.start().betti, [price[name] for name in BETTI]).tolist()
        text = f"{price['do']} the {price['class']} of row {price['row']}"
        goal = Goal(features=(Feature(do=price["do"], row=price["row"]),))
        found.append((text, Target(*after), goal))
    return found


def pick_targets(
    predicted: pd.DataFrame, at_base: BettiNumbers, wanted: Target | None
) -> list[Target]:
    """Return the configured target, and the Betti numbers of the widest ranges of thresholds.

    Betti numbers other than those of the base come first, because they cost something.

    Parameters
    ----------
    predicted
        See `tusqh.threshold.plateaus.Plateaus.table`.
    at_base
        The Betti numbers at the base.
    wanted
        The target of the model's configuration, if it has one.

    Examples
    --------
    >>> predicted = pd.DataFrame({
    ...     "upper": [1.0, 0.5, 0.2], "lower": [0.5, 0.2, 0.0], "width": [0.5, 0.3, 0.2],
    ...     "threshold": [0.75, 0.35, 0.1], "cells": 1, "volume_ratio": 1.0,
    ...     "betti_0": [1, 2, 3], "betti_1": 0, "betti_2": 0})
    >>> found = pick_targets(predicted, BettiNumbers(1, 0, 0), None)
    >>> [target.betti_0 for target in found]
    [2, 3, 1]
    """
    intervals = merge_intervals(predicted)
    widths = intervals[[*BETTI, "width"]].groupby(BETTI).sum().reset_index()
    widths["at_base"] = [tuple(row) == tuple(at_base) for row in widths[BETTI].to_numpy()]
    widths = widths.sort_values(["at_base", "width"], ascending=[True, False], kind="stable")
    targets = []
    if wanted is not None:
        targets = [wanted]
        # What the configured target selects: the Betti numbers of the base, or the widest others.
        meets = widths[matches(widths, wanted)]
        selected = meets[meets["at_base"]] if meets["at_base"].any() else meets
        widths = widths.drop(index=selected.index[:1])
    others = [Target(*numbers) for numbers in widths[BETTI].to_numpy(dtype=int).tolist()]
    return (targets + others)[:MOST_TARGETS]


def _measure(
    selection: Selection, target: Target, in_base: BoolArray, volume: float
) -> dict[str, Any]:
    """Return the cost of a mesh, and whether it has the target."""
    assert selection.resolved is not None  # Both scopes verify the mesh of a target.
    mesh, cells = selection.resolved.mesh, selection.resolved.cells
    measured = mesh.measurement
    numbers = pd.DataFrame([measured.by_euler, measured.by_boundary], columns=BETTI)
    return {
        "cells_changed": int((cells.kept != in_base).sum()),
        "volume_ratio": measured.volume / volume if volume > 0 else float("nan"),
        "volume_over_base": cells.kept.sum() / max(in_base.sum(), 1),
        "betti_measured": str(measured.by_euler),
        "holds": bool(measured.is_sound and matches(numbers, target).all()),
    }


def _distances(selection: Selection, surface: Surface) -> dict[str, float]:
    """Return the mean distances between the boundary of a mesh and the surface, in cells."""
    assert selection.resolved is not None
    found = measure_distances(selection.resolved.mesh, surface)
    mean = found[found["unit"] == "cells"].set_index(["from", "at"])["mean"]
    return {
        "boundary_mean": round(float(mean["boundary", "faces"]), 6),
        "surface_mean": round(float(mean["surface", "samples"]), 6),
    }
