from pathlib import Path

from tusqh.provenance.record import recorded
from tusqh.sampling.io import load_fractions
from tusqh.tables import write_csv
from tusqh.topology.curves import betti_curves
from tusqh.topology.persistence import (
    locate_pairs,
    paired_dimensions,
    persistence_pairs,
    require_agreement,
)

with recorded(snakemake) as log:
    fractions = load_fractions(Path(snakemake.input.fractions))
    plateaus = betti_curves(fractions.values)
    pairs = persistence_pairs(fractions.values, diagonal=True)
    is_on_diagonal = pairs["persistence"] == 0
    diagonal = pairs[is_on_diagonal].groupby(["dimension", "birth"]).size()
    pairs = pairs[~is_on_diagonal]
    dimensions = paired_dimensions(fractions.values.shape)
    log.info("%d plateaus, %d pairs of dimensions %s", len(plateaus), len(pairs), dimensions)
    require_agreement(pairs, plateaus, dimensions, name=snakemake.wildcards.model)
    write_csv(Path(snakemake.output.pairs), locate_pairs(pairs, fractions.grid))
    write_csv(Path(snakemake.output.diagonal), diagonal.reset_index(name="pairs"))
    write_csv(Path(snakemake.output.plateaus), plateaus)
