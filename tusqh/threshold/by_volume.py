"""The threshold whose mesh has the volume of the geometry."""

from __future__ import annotations

import numpy as np
import pandas as pd

from tusqh.threshold.candidates import CHOSEN, DISAGREES, Trial, list_plateaus, try_cells
from tusqh.threshold.describe_choice import describe_choice
from tusqh.threshold.errors import no_mesh_as_predicted, nothing_kept
from tusqh.threshold.plateaus import Plateaus
from tusqh.threshold.selection import Selection

#: This many thresholds, nearest by the volume of their cells, are meshed to match a volume.
VOLUME_TRIALS = 10


def choose_by_volume(plateaus: Plateaus, *, name: str) -> tuple[Selection, pd.DataFrame]:
    """Return the threshold whose mesh is closest to the winding-number volume.

    Parameters
    ----------
    plateaus
        The plateaus of the threshold.
    name
        The model, for messages.

    Returns
    -------
    selection, candidates
        See `tusqh.threshold.choose.choose_threshold`; candidates have a `volume_error`.

    Raises
    ------
    TopologyError
        No threshold keeps a cell, or no mesh measures as predicted.
    """
    predicted, cell_sets = plateaus.table, plateaus.cell_sets
    fractions = cell_sets.fractions
    wanted = fractions.volume()
    of_cells = predicted["cells"] * fractions.grid.cell_size**fractions.grid.dim
    shown = predicted.assign(error=(of_cells - wanted).abs())[predicted["cells"] > 0]
    if shown.empty:
        raise nothing_kept(cell_sets, predicted["threshold"].min(), name)
    candidates = list_plateaus(shown.sort_values("error", kind="stable").head(VOLUME_TRIALS))
    errors = np.zeros(len(candidates))
    best: tuple[int, Trial] | None = None
    for index, threshold in enumerate(candidates["threshold"].to_numpy()):
        trial = try_cells(cell_sets.at(threshold), fractions.grid, name=name)
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
        wanted="the winding-number volume",
        reason="the mesh's volume differs from the winding-number volume by "
        f"{100 * row['volume_error']:+.3g} %, the least of {len(candidates)} thresholds",
        resolved=trial.resolved,
    )
    return selection, candidates
