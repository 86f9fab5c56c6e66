from pathlib import Path

from tusqh.provenance.record import recorded
from tusqh.sampling.io import load_fractions
from tusqh.tables import write_csv
from tusqh.topology.filtration import build_filtration
from tusqh.topology.persistence import list_plateaus, locate_pairs, persistence_pairs

with recorded(snakemake) as log:
    fractions = load_fractions(Path(snakemake.input.fractions))
    filtration = build_filtration(fractions.values)
    log.info("%s simplices by dimension", [len(s) for s in filtration.simplices])
    pairs = persistence_pairs(filtration)
    plateaus = list_plateaus(filtration, pairs)
    log.info("%d pairs, %d plateaus", len(pairs), len(plateaus))
    write_csv(Path(snakemake.output.pairs), locate_pairs(pairs, filtration, fractions.grid))
    write_csv(Path(snakemake.output.plateaus), plateaus)
