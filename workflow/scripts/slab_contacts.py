from pathlib import Path

from provenance.record import recorded
from tusqh.geometry.canonical import load_geometry
from tusqh.pipeline.slabs.sample import original_of
from tusqh.pipeline.slabs.steps import decide, read_layout
from tusqh.settings.model import Settings

with recorded(snakemake) as log:
    geometry = Path(snakemake.input.geometry)
    settings = Settings.from_dict(snakemake.params.settings)
    cells = decide(
        read_layout(Path(snakemake.input.slab_grid)),
        original_of(load_geometry(geometry), settings),
        geometry.parent,
        Path(snakemake.output.slab_contacts),
        name=snakemake.wildcards.model,
    )
    log.info("%d kept cells, %d contacts", cells.kept.sum(), len(cells.contacts))
