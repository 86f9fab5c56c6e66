"""Stage 3: which topology every threshold gives, before any mesh is made."""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd

from tusqh.sampling.fractions import VolumeFractions
from tusqh.topology.curves import betti_curves
from tusqh.topology.persistence import (
    locate_pairs,
    paired_dimensions,
    persistence_pairs,
    require_agreement,
)


@dataclass(frozen=True)
class Persistence:
    """The topology of the filtration, counted in two independent ways.

    Parameters
    ----------
    curves
        Raw Betti numbers of every plateau of the threshold, see
        `tusqh.topology.curves.betti_curves`.
    diagram
        Persistence pairs with the places that create and destroy each class, see
        `tusqh.topology.persistence.locate_pairs`.
    diagonal
        Number of pairs that live over no range of thresholds, by `dimension` and `birth`.
    """

    curves: pd.DataFrame
    diagram: pd.DataFrame
    diagonal: pd.DataFrame


def find_persistence(fractions: VolumeFractions, *, name: str = "model") -> Persistence:
    """Return Betti curves and persistence diagram of volume fractions.

    Raises
    ------
    TopologyError
        Pairs and curves differ, which is a fault of tusqh or gudhi, never of the geometry.
    """
    curves = betti_curves(fractions.values)
    pairs = persistence_pairs(fractions.values, diagonal=True)
    is_on_diagonal = pairs["persistence"] == 0
    diagonal = pairs[is_on_diagonal].groupby(["dimension", "birth"]).size()
    pairs = pairs[~is_on_diagonal]
    require_agreement(pairs, curves, paired_dimensions(fractions.values.shape), name=name)
    diagram = locate_pairs(pairs, fractions.grid)
    return Persistence(curves, diagram, diagonal.reset_index(name="pairs"))
