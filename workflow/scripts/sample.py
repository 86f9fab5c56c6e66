from pathlib import Path

from provenance.record import recorded
from tusqh.geometry.canonical import load_geometry
from tusqh.pipeline.sample import sample
from tusqh.sampling.io import save_fractions
from tusqh.settings.grid import Grid, Window
from tusqh.settings.sampling import Sampling

with recorded(snakemake) as log:
    geometry = load_geometry(Path(snakemake.input.geometry))
    window = snakemake.params.window
    fractions = sample(
        geometry,
        grid=Grid.from_dict(snakemake.params.grid),
        sampling=Sampling.from_dict(snakemake.params.sampling),
        window=window and Window.from_dict(window),
        threshold=snakemake.params.threshold,
    )
    log.info("%s cells of size %g", fractions.grid.label, fractions.grid.cell_size)
    log.info("grid %s", fractions.placement or "at the corner")
    save_fractions(Path(snakemake.output.fractions), fractions)
