import json
from pathlib import Path

from provenance.record import recorded
from tusqh.geometry.canonical import load_geometry
from tusqh.pipeline.slabs.sample import original_of
from tusqh.pipeline.slabs.steps import merge, read_layout
from tusqh.settings.model import Settings

with recorded(snakemake) as log:
    settings = Settings.from_dict(snakemake.params.settings)
    report = merge(
        read_layout(Path(snakemake.input.slab_grid)),
        original_of(load_geometry(Path(snakemake.input.geometry)), settings),
        settings,
        Path(snakemake.output.slab_mesh).parent,
        reading=json.loads(Path(snakemake.input.reading).read_text("utf-8")),
        name=snakemake.wildcards.model,
    )
    log.info("%(elements)d elements, Betti numbers %(betti_measured)s", report.facts)
