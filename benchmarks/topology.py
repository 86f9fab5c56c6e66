"""Betti curves and diagrams against gudhi: ``python -m benchmarks.topology``.

The field is white noise on the doubled grid, which is the hardest case, because nearly every node
has its own level.  `gudhi simplicial` builds and pairs the paper's complex with all its simplices;
`gudhi cubical` pairs the cells without sub-cells, a different complex that serves as a reference.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
import pandas as pd

from benchmarks.measure import FIELDS, Cost, compare, growth, measure
from tusqh.grid import FloatArray
from tusqh.sampling.fractions import round_fractions
from tusqh.tables import write_csv
from tusqh.topology.filtration import build_filtration
from tusqh.topology.topology import Topology

RESULT = Path("results/benchmarks/topology.csv")


def white_noise(n: int) -> FloatArray:
    """Return random fractions for n^3 cells, shape (2 n + 1,) * 3."""
    values = np.random.default_rng(0).random((2 * n + 1,) * 3)
    return round_fractions(values)


def tabulate_curves(values: FloatArray) -> object:
    """Count the Betti numbers between all distinct fractions."""
    return Topology.from_fractions(values).curves


def pair(values: FloatArray) -> object:
    """Pair everything."""
    return Topology.from_fractions(values).pairs


def pair_simplicial(values: FloatArray) -> object:
    """Pair the paper's whole complex with gudhi."""
    import gudhi

    filtration = build_filtration(values)
    tree = gudhi.SimplexTree()
    for k, simplices in enumerate(filtration.simplices):
        tree.insert_batch(simplices.T.astype(np.int32), -filtration.simplex_values(k))
    return tree.persistence(homology_coeff_field=2)


def pair_cubical(values: FloatArray) -> object:
    """Pair the cells alone with gudhi, as vertices of a cubical complex."""
    import gudhi

    cells = values[1::2, 1::2, 1::2]
    return gudhi.CubicalComplex(vertices=-cells).persistence(homology_coeff_field=2)


def curves_cubical(values: FloatArray) -> object:
    """Pair the cells alone with gudhi, and count the classes between all distinct fractions."""
    levels = np.unique(values[1::2, 1::2, 1::2])
    ends = {k: ([], []) for k in range(3)}  # type: dict[int, tuple[list[float], list[float]]]
    for k, (birth, death) in pair_cubical(values):  # type: ignore[attr-defined]
        ends[k][0].append(-birth)
        ends[k][1].append(-death)
    return [
        np.searchsorted(np.sort(deaths), levels) - np.searchsorted(np.sort(births), levels)
        for births, deaths in ends.values()
    ]


def pair_cripser(values: FloatArray) -> object:
    """Pair the cells alone with cripser, as vertices of a cubical complex."""
    import cripser

    return cripser.computePH(-values[1::2, 1::2, 1::2], maxdim=2)


def cost_of(call: object, n: int) -> Cost:
    """Return the cost of a call on n^3 cells."""
    return measure(white_noise, call, (4,), n)  # type: ignore[arg-type]


def main() -> None:
    """Measure, print and write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--largest", type=int, default=256, help="cells along a side (256)")
    largest = parser.parse_args().largest
    rows = []
    others = {32: ("gudhi simplicial", pair_simplicial), 64: ("gudhi cubical", pair_cubical)}
    others[128] = others[64]
    for n in (n for n in (32, 64, 128, 256) if n <= largest):
        name, other = others.get(n, ("", None))
        reference = cost_of(other, n) if other else None
        rows.append(compare("betti_curves", n**3, cost_of(tabulate_curves, n), name, reference))
    if len(rows) > 2:
        print(f"betti_curves: seconds grow with cells to the power {growth(rows[1:]):.2f}")
    others = dict.fromkeys((32, 64), ("gudhi simplicial", pair_simplicial))
    for n in (n for n in (32, 64, 128) if n <= largest):
        name, other = others.get(n, ("", None))
        reference = cost_of(other, n) if other else None
        rows.append(compare("persistence_pairs", n**3, cost_of(pair, n), name, reference))
    write_csv(RESULT, pd.DataFrame(rows, columns=FIELDS))


if __name__ == "__main__":
    main()
