from dataclasses import replace
from pathlib import Path

from provenance.record import recorded
from tusqh.figures import style
from tusqh.figures.fit import draw_fit
from tusqh.figures.jacobians import draw_jacobians
from tusqh.figures.sets import draw_sets
from tusqh.geometry.canonical import load_geometry
from tusqh.geometry.units import ASSUMED
from tusqh.geometry.upright import upright_axis
from tusqh.meshes.export import read_vtu
from tusqh.meshes.formats import make_content
from tusqh.meshes.patches import read_patches
from tusqh.pipeline.exports import export_of

with recorded(snakemake) as log:
    geometry = load_geometry(Path(snakemake.input.geometry))
    staircase, fitted = (read_vtu(Path(snakemake.input[name])) for name in ("mesh", "fitted"))
    name, paths = snakemake.wildcards.model, snakemake.output
    fitted = replace(fitted, name=name)
    up = upright_axis(snakemake.params.geometry, snakemake.params.up)
    unit = geometry.unit or ASSUMED
    figure = draw_fit(geometry, staircase, fitted, name=name, unit=unit, up=up)
    style.save(figure, Path(paths.figure_fit))
    style.save(draw_jacobians(staircase, fitted, name=name), Path(paths.figure_jacobians))
    patch = read_patches(Path(snakemake.input.patches), fitted)
    how = export_of(fitted, geometry, is_fitted=True, patch=patch)
    content = make_content(fitted, None, how)
    style.save(draw_sets(fitted, content.sets, up=up), Path(paths.figure_sets))
