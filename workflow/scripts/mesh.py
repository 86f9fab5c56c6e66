import json
from pathlib import Path

from provenance.record import recorded
from tusqh.pipeline.build import build
from tusqh.sampling.io import load_fractions
from tusqh.threshold.select import Selection

WRITTEN = ("mesh", "certificate", "features", "bridges", "facts")

with recorded(snakemake) as log:
    fractions = Path(snakemake.input.fractions)
    selection = Selection.from_dict(json.loads(Path(snakemake.input.selection).read_text()))
    built = build(load_fractions(fractions), selection, name=snakemake.wildcards.model)
    log.info("%(elements)d elements, Betti numbers %(betti_measured)s", built.facts)
    built.write(fractions=fractions, **{name: Path(snakemake.output[name]) for name in WRITTEN})
