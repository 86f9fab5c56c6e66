from pathlib import Path

from tusqh.figures import style
from tusqh.figures.thresholds import draw_thresholds
from tusqh.geometry.io import load_outline
from tusqh.provenance.record import recorded
from tusqh.sampling.io import load_fractions

with recorded(snakemake) as log:
    figure = draw_thresholds(
        load_fractions(Path(snakemake.input.fractions)),
        load_outline(Path(snakemake.input.geometry)),
        snakemake.params.drawing["panels"],
        name=snakemake.wildcards.model,
        unit=snakemake.params.drawing["unit"],
        resolution=snakemake.params.resolution,
    )
    style.save(figure, Path(snakemake.output.figure))
