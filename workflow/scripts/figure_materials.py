from pathlib import Path

from provenance.record import recorded
from tusqh.figures import style
from tusqh.figures.materials import draw_materials
from tusqh.geometry.upright import upright_axis
from tusqh.meshes.export import read_regions, read_vtu

with recorded(snakemake) as log:
    path = Path(snakemake.input.mesh)
    figure = draw_materials(
        read_vtu(path, name=snakemake.wildcards.model),
        read_regions(path),
        unit=snakemake.params.unit,
        up=upright_axis(snakemake.params.geometry, snakemake.params.up),
    )
    style.save(figure, Path(snakemake.output.figure_materials))
