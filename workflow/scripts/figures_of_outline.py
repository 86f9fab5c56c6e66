from pathlib import Path

import pandas as pd

from provenance.record import recorded
from tusqh.antialias.cells import CellSets
from tusqh.figures import style
from tusqh.figures.antialias import draw_antialias
from tusqh.figures.contaminant import draw_contaminant
from tusqh.figures.field import draw_field
from tusqh.figures.thresholds import draw_thresholds
from tusqh.geometry.canonical import load_geometry
from tusqh.geometry.units import ASSUMED
from tusqh.meshes.export import read_vtu
from tusqh.sampling.io import load_fractions
from tusqh.simulate.snapshots import read_snapshot
from tusqh.threshold.selection import load_selection

with recorded(snakemake) as log:
    name = snakemake.wildcards.model
    geometry = load_geometry(Path(snakemake.input.geometry))
    fractions = load_fractions(Path(snakemake.input.fractions))
    selection = load_selection(Path(snakemake.input.selection))
    mesh = read_vtu(Path(snakemake.input.mesh), name=name)
    unit = mesh.unit or ASSUMED
    field = draw_field(fractions, geometry, name=name, unit=unit)
    style.save(field, Path(snakemake.output.figure_field))
    cell_sets, panels = CellSets(fractions, selection.policy), snakemake.params.panels
    thresholds = draw_thresholds(cell_sets, geometry, panels, name=name, unit=unit)
    style.save(thresholds, Path(snakemake.output.figure_thresholds))
    antialias = draw_antialias(
        fractions, mesh, threshold=selection.threshold, base=selection.base, unit=unit
    )
    style.save(antialias, Path(snakemake.output.figure_antialias))
    snapshots = [read_snapshot(Path(path)) for path in snakemake.input.snapshots]
    points, cells, _ = snapshots[0]
    fields, amount = [field for _, _, field in snapshots], pd.read_csv(snakemake.input.amount)
    contaminant = draw_contaminant(points, cells, fields, amount, name=name, unit=unit)
    style.save(contaminant, Path(snakemake.output.figure_contaminant))
