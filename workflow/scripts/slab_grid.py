from pathlib import Path

from provenance.record import recorded
from tusqh.atomic import write_text
from tusqh.geometry.canonical import load_geometry
from tusqh.hashing import canonical_json
from tusqh.pipeline.slabs.sample import original_of
from tusqh.pipeline.slabs.steps import lay
from tusqh.settings.model import Settings

with recorded(snakemake) as log:
    settings = Settings.from_dict(snakemake.params.settings)
    original = original_of(load_geometry(Path(snakemake.input.geometry)), settings)
    path, n_slabs = Path(snakemake.output.slab_grid), snakemake.params.slabs
    layout = lay(original, settings, n_slabs, path.parent, name=snakemake.wildcards.model)
    log.info("%s cells in %d slabs", layout.grid.label, n_slabs)
    log.info("grid %s", layout.placement or "at the corner")
    write_text(path, canonical_json(layout.to_dict()))
