from pathlib import Path

import pandas as pd

from provenance.record import recorded
from tusqh.figures import style
from tusqh.figures.panels import draw_panels
from tusqh.figures.section import draw_sections
from tusqh.figures.temperature import draw_temperature
from tusqh.geometry.canonical import load_geometry
from tusqh.geometry.units import ASSUMED
from tusqh.geometry.upright import upright_axis
from tusqh.meshes.export import read_vtu
from tusqh.simulate.snapshots import read_snapshot

with recorded(snakemake) as log:
    name = snakemake.wildcards.model
    rows = pd.read_csv(snakemake.input.verification)
    meshes = [
        read_vtu(Path(path)) if n_elements else None
        for path, n_elements in zip(snakemake.input.meshes, rows["elements"], strict=True)
    ]
    geometry = load_geometry(Path(snakemake.input.geometry))
    unit = geometry.unit or ASSUMED
    up = upright_axis(snakemake.params.geometry, snakemake.params.up)
    thresholds = rows["threshold"].tolist()
    panels = draw_panels(geometry, meshes, thresholds, name=name, unit=unit, up=up)
    style.save(panels, Path(snakemake.output.figure_panels))
    mesh = read_vtu(Path([snakemake.input.mesh, *snakemake.input.fitted][-1]))
    sections = draw_sections(geometry, mesh, name=name, unit=unit)
    style.save(sections, Path(snakemake.output.figure_section))
    snapshots = [read_snapshot(Path(path)) for path in snakemake.input.snapshots]
    points, cells, _ = snapshots[0]
    fields, amount = [field for _, _, field in snapshots], pd.read_csv(snakemake.input.amount)
    temperature = draw_temperature(points, cells, fields, amount, name=name, up=up)
    style.save(temperature, Path(snakemake.output.figure_temperature))
