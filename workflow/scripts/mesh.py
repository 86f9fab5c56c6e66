from pathlib import Path

from provenance.record import recorded
from tusqh.geometry.canonical import load_geometry
from tusqh.pipeline.build import build, require_volume
from tusqh.pipeline.original import Original
from tusqh.sampling.io import load_fractions
from tusqh.threshold.selection import load_selection

WRITTEN = ("mesh", "certificate", "features", "bridges", "changes", "facts")

with recorded(snakemake) as log:
    fractions = Path(snakemake.input.fractions)
    geometry = load_geometry(Path(snakemake.input.geometry))
    built = build(
        load_fractions(fractions),
        load_selection(Path(snakemake.input.selection)),
        name=snakemake.wildcards.model,
        original=Original.from_dict(geometry, snakemake.params),
    )
    if snakemake.params.goal.get("volume"):
        require_volume(built)
    log.info("%(elements)d elements, Betti numbers %(betti_measured)s", built.facts)
    built.write(fractions=fractions, **{name: Path(snakemake.output[name]) for name in WRITTEN})
