from pathlib import Path

from provenance.record import recorded
from tusqh.pipeline.persistence import find_persistence
from tusqh.sampling.io import load_fractions
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    fractions = load_fractions(Path(snakemake.input.fractions))
    found = find_persistence(fractions, name=snakemake.wildcards.model)
    log.info("%d plateaus, %d pairs", len(found.curves), len(found.diagram))
    write_csv(Path(snakemake.output.diagram), found.diagram)
    write_csv(Path(snakemake.output.diagonal), found.diagonal)
    write_csv(Path(snakemake.output.curves), found.curves)
