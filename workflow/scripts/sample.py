from pathlib import Path

from provenance.record import recorded
from tusqh.geometry.canonical import load_geometry
from tusqh.pipeline.sample import sample
from tusqh.sampling.io import save_fractions

with recorded(snakemake) as log:
    geometry = load_geometry(Path(snakemake.input.geometry))
    fractions = sample(geometry, **snakemake.params.grid, **snakemake.params.sampling)
    log.info("%s cells of size %g", fractions.grid.label, fractions.grid.cell_size)
    save_fractions(Path(snakemake.output.fractions), fractions)
