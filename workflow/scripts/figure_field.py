from pathlib import Path

from provenance.record import recorded
from tusqh.figures import style
from tusqh.figures.field import draw_field
from tusqh.geometry.canonical import load_geometry
from tusqh.sampling.io import load_fractions

with recorded(snakemake) as log:
    figure = draw_field(
        load_fractions(Path(snakemake.input.fractions)),
        load_geometry(Path(snakemake.input.geometry)),
        name=snakemake.wildcards.model,
        unit=snakemake.params.unit,
    )
    style.save(figure, Path(snakemake.output.figure))
