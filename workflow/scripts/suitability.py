from pathlib import Path

from provenance.record import recorded
from studies.suitability import OWN_THRESHOLD, compare_suitability, split_iterations
from tusqh.antialias.cells import CellSets
from tusqh.sampling.io import load_fractions
from tusqh.tables import write_csv
from tusqh.threshold.selection import load_selection

with recorded(snakemake) as log:
    selection = load_selection(Path(snakemake.input.selection))
    fractions = load_fractions(Path(snakemake.input.fractions))
    table = compare_suitability(
        CellSets(fractions, selection.policy),
        {OWN_THRESHOLD: selection.threshold, "one half": 0.5},
        selection.predicted,
        name=snakemake.wildcards.model,
    )
    log.info("%d meshes, %d manifold", len(table), table["manifold"].sum())
    suitability, iterations = split_iterations(table)
    write_csv(Path(snakemake.output.table), suitability)
    write_csv(Path(snakemake.output.iterations), iterations)
