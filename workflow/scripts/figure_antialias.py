import json
from pathlib import Path

from provenance.record import recorded
from tusqh.figures import style
from tusqh.figures.antialias import draw_antialias
from tusqh.meshes.export import read_vtu
from tusqh.sampling.io import load_fractions

with recorded(snakemake) as log:
    figure = draw_antialias(
        load_fractions(Path(snakemake.input.fractions)),
        read_vtu(Path(snakemake.input.mesh), name=snakemake.wildcards.model),
        threshold=json.loads(Path(snakemake.input.selection).read_text())["threshold"],
        unit=snakemake.params.unit,
    )
    style.save(figure, Path(snakemake.output.figure))
