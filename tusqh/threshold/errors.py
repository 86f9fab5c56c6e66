"""Make the errors for goals that no threshold reaches."""

from __future__ import annotations

import numpy as np
import pandas as pd

from tusqh.antialias.cells import CellSets
from tusqh.errors import TopologyError
from tusqh.local_topology.classes import CLASSES
from tusqh.local_topology.features import Features
from tusqh.settings.goal import Target
from tusqh.threshold.goals import distances
from tusqh.threshold.plateaus import list_intervals, list_reachable, merge_intervals
from tusqh.topology.betti_numbers import BettiNumbers

#: Largest number of intervals that are listed if a target is not reached.
NEAREST = 10


def unreachable_target(predicted: pd.DataFrame, target: Target, name: str) -> TopologyError:
    """Return the error for Betti numbers that no threshold gives.

    Parameters
    ----------
    predicted
        See `tusqh.threshold.plateaus.Plateaus.table`.
    target
        The target Betti numbers.
    name
        The model.
    """
    return TopologyError(
        f"no threshold gives {target}",
        where=name,
        expected="Betti numbers that some threshold reaches, the nearest first:\n"
        + _list_nearest(predicted, target),
        remedy="ask for one of these, use another grid (`--cells`), or remove small components "
        "(`--min-cells`) or fill small holes in 2D and voids in 3D (`--holes-min-cells`, "
        "`--voids-min-cells`)",
    )


def _list_nearest(predicted: pd.DataFrame, target: Target) -> str:
    """Return the intervals nearest to a target as lines of text."""
    intervals = merge_intervals(predicted)
    order = np.lexsort((-intervals["width"].to_numpy(), distances(intervals, target)))
    nearest = intervals.iloc[order[:NEAREST]]
    n_more = len(intervals) - len(nearest)
    more = f"\n    and {n_more} more intervals: `tusqh inspect --all` lists them" if n_more else ""
    return list_intervals(nearest) + more


def unreachable_by_features(
    predicted: pd.DataFrame,
    features: Features,
    nearest: BettiNumbers,
    target: Target,
    *,
    name: str,
) -> TopologyError:
    """Return the error for Betti numbers that no threshold and no choice of cuts and fills gives.

    Parameters
    ----------
    predicted
        See `tusqh.threshold.plateaus.Plateaus.table`.
    features
        The classes at the base.
    nearest
        The nearest Betti numbers that were found.
    target
        The target Betti numbers.
    name
        The model.
    """
    classes = features.classes
    numbers = ", ".join(
        f"{(classes['class'] == kind).sum()} of the class {kind} "
        f"({(classes['is_there'] & (classes['class'] == kind)).sum()} of them at the base)"
        for kind in CLASSES[: features.grid.dim]
    )
    wanted = target.given()
    if distances(pd.DataFrame([{"betti_0": 0}]), Target(betti_0=wanted.get("betti_0", 1)))[0] == 0:
        why = "a mesh has at least one component"
    else:
        why = f"the diagram has {numbers}, and each can be opened, cut or filled only once"
    return TopologyError(
        f"no threshold gives {target}, and no features opened, cut or filled at "
        f"{features.base:.6g} do",
        where=name,
        expected=f"Betti numbers that can be reached. The nearest found with features are "
        f"{nearest}: {why}. By one threshold, the nearest first:\n"
        + _list_nearest(predicted, target),
        remedy="ask for these, use another grid (`--cells`) or `--base`, or name features "
        "(`--open`, `--cut`, `--fill`), whose prices are in prices.csv",
    )


def unreachable_persistence(predicted: pd.DataFrame, wanted: str, name: str) -> TopologyError:
    """Return the error for features that persistence cannot separate.

    Parameters
    ----------
    predicted
        See `tusqh.threshold.plateaus.Plateaus.table`.
    wanted
        The request, in words.
    name
        The model.
    """
    return TopologyError(
        f"neither a threshold alone nor removing and filling features leaves {wanted}",
        where=name,
        expected="features that can be told apart by their persistence",
        remedy="lower `persistence`, or ask for Betti numbers with `target`:\n"
        + list_reachable(predicted),
    )


def no_mesh_as_predicted(name: str) -> TopologyError:
    """Return the error for candidates if no mesh measures as predicted.

    Parameters
    ----------
    name
        The model.
    """
    return TopologyError(
        "no mesh near the wanted volume measures as predicted",
        where=name,
        expected="a mesh with the predicted Betti numbers",
        remedy="this is a fault of tusqh: please report it with fractions.npz",
    )


def threshold_out_of_range(threshold: float, name: str) -> TopologyError:
    """Return the error for a threshold that is not a volume fraction above 0.

    Parameters
    ----------
    threshold
        The given threshold.
    name
        The model.
    """
    return TopologyError(
        f"the threshold is {threshold}",
        where=name,
        expected="a volume fraction in (0, 1]",
        remedy="use 0.5, or ask for Betti numbers with `target`",
    )


def nothing_kept(cell_sets: CellSets, threshold: float, name: str) -> TopologyError:
    """Return the error for a threshold that keeps no cell.

    Parameters
    ----------
    cell_sets
        The cells of every threshold.
    threshold
        The threshold.
    name
        The model.
    """
    largest = cell_sets.fractions.cells.max()
    return TopologyError(
        f"no cell is left at threshold {threshold:g}",
        where=name,
        expected=f"a threshold of at most {largest:.4g}, the largest fraction, and components "
        "that meet the criteria",
        remedy="lower `threshold` or the criteria for `components`, or use a finer grid",
    )


def unknown_volume(name: str, *, wish: str = "`--match-volume`") -> TopologyError:
    """Return the error for matching a volume that is unknown.

    Parameters
    ----------
    name
        The model.
    wish
        The setting that needs the volume.
    """
    return TopologyError(
        f"{wish} of a geometry that encloses nothing",
        where=name,
        expected="a geometry with a volume",
        remedy="close the surface, use `--orientation flip` if its parts are inside out, or give a "
        "`threshold`",
    )


def no_threshold_alone(wanted: str, name: str) -> TopologyError:
    """Return the error for matching a volume if features would also have to be removed.

    Parameters
    ----------
    wanted
        The request, in words.
    name
        The model.
    """
    return TopologyError(
        f"no threshold alone leaves {wanted}, so there is none whose volume could be matched",
        where=name,
        expected="a threshold at which no short-lived feature lives",
        remedy="lower `persistence`, leave out `--match-volume` so that short-lived features are "
        "removed and filled, or ask for Betti numbers with `--betti`",
    )
