"""Choose the threshold whose mesh best matches the volume of the geometry."""

from __future__ import annotations

from functools import partial

import numpy as np
import pandas as pd

from tusqh.grid import BoolArray
from tusqh.local_topology.move import approach
from tusqh.threshold.candidates import CHOSEN, DISAGREES, Trial, list_plateaus, try_cells
from tusqh.threshold.describe_choice import describe_choice, find_interval_around
from tusqh.threshold.errors import no_mesh_as_predicted, nothing_kept, unknown_volume
from tusqh.threshold.plateaus import BETTI, Plateaus
from tusqh.threshold.selection import Selection

#: Number of thresholds, those whose cells have the nearest volumes, that are meshed.
VOLUME_TRIALS = 10


def choose_by_volume(
    plateaus: Plateaus,
    is_wanted: BoolArray | None = None,
    *,
    also: str = "",
    base: float | None = None,
    name: str,
) -> tuple[Selection, pd.DataFrame]:
    """Return the threshold whose mesh has the volume nearest to that of the geometry.

    Parameters
    ----------
    plateaus
        The plateaus of the threshold, with the volume of the geometry.
    is_wanted
        Which plateaus also meet the rest of the request; None: all.
    also
        The rest of the request, in words.
    base
        The threshold whose cells are kept except where the topology needs others, see
        `tusqh.local_topology.move`; None: the chosen threshold keeps its own cells.
    name
        The model, for messages.

    Returns
    -------
    selection, candidates
        See `tusqh.threshold.choose.choose_threshold`; candidates have a `volume_error`.

    Raises
    ------
    TopologyError
        The volume of the geometry is unknown, no threshold keeps a cell, or no mesh measures as
        predicted.
    """
    predicted, wanted = plateaus.table, plateaus.reference.volume
    cell_sets = approach(plateaus.cell_sets, base)
    if wanted <= 0:
        raise unknown_volume(name)
    is_usable = (predicted["cells"] > 0).to_numpy()
    if not is_usable.any():
        raise nothing_kept(cell_sets, predicted["threshold"].min(), name)
    if is_wanted is not None:
        is_usable = is_usable & is_wanted
    # One plateau is enough for each set of cells and Betti numbers.
    distinct = predicted[is_usable].drop_duplicates(["cells", *BETTI])
    order = (distinct["volume_ratio"] - 1).abs().sort_values(kind="stable").index
    candidates = list_plateaus(distinct.loc[order[:VOLUME_TRIALS]])
    errors = np.zeros(len(candidates))
    best: tuple[int, Trial] | None = None
    for index, threshold in enumerate(candidates["threshold"].to_numpy()):
        trial = try_cells(cell_sets.at(threshold), cell_sets.fractions.grid, name=name)
        errors[index] = trial.resolved.mesh.measurement.volume / wanted - 1
        if not trial.is_verified:
            candidates.loc[index, "status"] = DISAGREES
        elif best is None or abs(errors[index]) < abs(errors[best[0]]):
            best = index, trial
    candidates["volume_error"] = errors
    if best is None:
        raise no_mesh_as_predicted(name)
    index, trial = best
    candidates.loc[index, "status"] = CHOSEN
    row = candidates.iloc[index]
    selection = describe_choice(
        plateaus,
        row,
        trial.cells,
        wanted=f"{plateaus.reference.source}, with {also}" if also else plateaus.reference.source,
        reason=f"the mesh's volume differs from {plateaus.reference.source} by "
        f"{100 * row['volume_error']:+.3g} %, the least of {len(candidates)} thresholds"
        + (f" with {also}" if also else ""),
        find_interval=partial(
            find_interval_around, plateaus, float(row["threshold"]), trial.cells.predicted
        ),
        resolved=trial.resolved,
    )
    return selection, candidates
