from pathlib import Path

from provenance.record import recorded
from tusqh.meshes.export import read_vtu
from tusqh.pipeline.coarsen import WRITTEN, coarsen
from tusqh.sampling.io import load_fractions

with recorded(snakemake) as log:
    source = Path([snakemake.input.mesh, *snakemake.input.fitted][-1])
    grid = load_fractions(Path(snakemake.input.fractions)).grid
    mesh = read_vtu(source, name=snakemake.wildcards.model)
    result = coarsen(mesh, grid, snakemake.params.coarsening["coarsen"])
    log.info("%s", result.line())
    result.write(source=source, **{name: Path(snakemake.output[name]) for name in WRITTEN})
