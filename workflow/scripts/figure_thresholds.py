from pathlib import Path

from provenance.record import recorded
from tusqh.antialias.cells import CellSets
from tusqh.figures import style
from tusqh.figures.thresholds import draw_thresholds
from tusqh.geometry.canonical import load_geometry
from tusqh.sampling.io import load_fractions
from tusqh.threshold.selection import load_selection

with recorded(snakemake) as log:
    policy = load_selection(Path(snakemake.input.selection)).policy
    figure = draw_thresholds(
        CellSets(load_fractions(Path(snakemake.input.fractions)), policy),
        load_geometry(Path(snakemake.input.geometry)),
        snakemake.params.panels,
        name=snakemake.wildcards.model,
        unit=snakemake.params.unit,
    )
    style.save(figure, Path(snakemake.output.figure))
