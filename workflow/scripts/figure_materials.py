from pathlib import Path

from provenance.record import recorded
from tusqh.figures import style
from tusqh.figures.materials import draw_materials
from tusqh.geometry.units import ASSUMED
from tusqh.geometry.upright import upright_axis
from tusqh.meshes.export import read_regions, read_vtu

with recorded(snakemake) as log:
    path = Path(snakemake.input.mesh)
    mesh = read_vtu(path, name=snakemake.wildcards.model)
    figure = draw_materials(
        mesh,
        read_regions(path),
        unit=mesh.unit or ASSUMED,
        up=upright_axis(snakemake.params.geometry, snakemake.params.up),
    )
    style.save(figure, Path(snakemake.output.figure_materials))
