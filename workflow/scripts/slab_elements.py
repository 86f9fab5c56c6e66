from pathlib import Path

from provenance.record import recorded
from tusqh.pipeline.slabs.steps import emit_elements, read_layout

with recorded(snakemake):
    emit_elements(
        read_layout(Path(snakemake.input.slab_grid)),
        Path(snakemake.input.slab_contacts),
        int(snakemake.wildcards.slab),
        Path(snakemake.output.elements),
    )
