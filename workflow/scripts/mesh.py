from pathlib import Path

from provenance.record import recorded
from tusqh.pipeline.build import build
from tusqh.sampling.io import load_fractions
from tusqh.threshold.selection import load_selection

WRITTEN = ("mesh", "certificate", "features", "bridges", "facts")

with recorded(snakemake) as log:
    fractions = Path(snakemake.input.fractions)
    selection = load_selection(Path(snakemake.input.selection))
    built = build(load_fractions(fractions), selection, name=snakemake.wildcards.model)
    log.info("%(elements)d elements, Betti numbers %(betti_measured)s", built.facts)
    built.write(fractions=fractions, **{name: Path(snakemake.output[name]) for name in WRITTEN})
