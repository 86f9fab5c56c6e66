from pathlib import Path

from provenance.record import recorded
from tusqh.geometry.canonical import load_geometry
from tusqh.pipeline.slabs.sample import original_of
from tusqh.pipeline.slabs.steps import read_layout
from tusqh.settings.model import Settings

with recorded(snakemake) as log:
    settings = Settings.from_dict(snakemake.params.settings)
    original = original_of(load_geometry(Path(snakemake.input.geometry)), settings)
    layout = read_layout(Path(snakemake.input.slab_grid))
    folder = Path(snakemake.input.geometry).parent
    slab = layout.slabs[int(snakemake.wildcards.slab)]
    layout.fractions(folder, original).multiples(slab)
    log.info("cells %d to %d along x", slab.begin, slab.end)
