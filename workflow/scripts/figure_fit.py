from pathlib import Path

from provenance.record import recorded
from tusqh.figures import style
from tusqh.figures.fit import draw_fit
from tusqh.geometry.canonical import load_geometry
from tusqh.geometry.units import ASSUMED
from tusqh.geometry.upright import upright_axis
from tusqh.meshes.export import read_vtu

with recorded(snakemake) as log:
    geometry = load_geometry(Path(snakemake.input.geometry))
    staircase, fitted = (read_vtu(Path(snakemake.input[name])) for name in ("mesh", "fitted"))
    figure = draw_fit(
        geometry,
        staircase,
        fitted,
        name=snakemake.wildcards.model,
        unit=geometry.unit or ASSUMED,
        up=upright_axis(snakemake.params.geometry, snakemake.params.up),
    )
    style.save(figure, Path(snakemake.output.figure_fit))
