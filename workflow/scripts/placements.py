from pathlib import Path

from provenance.record import recorded
from studies.orientation import STUDY_THRESHOLDS, vary_placement
from studies.spread import measure_spread
from studies.stability import map_stability, recommend_grid
from tusqh.geometry.canonical import load_geometry
from tusqh.progress import log_progress
from tusqh.settings.goal import Goal
from tusqh.settings.grid import Window
from tusqh.settings.sampling import Sampling
from tusqh.tables import write_csv
from tusqh.threshold.selection import load_selection

with recorded(snakemake) as log:
    selection = load_selection(Path(snakemake.input.selection))
    target = Goal.from_dict(snakemake.params.goal).target
    window = snakemake.params.window
    name = snakemake.wildcards.model
    table = vary_placement(
        load_geometry(Path(snakemake.input.geometry)),
        selection.policy,
        sorted({*STUDY_THRESHOLDS, selection.threshold}),
        snakemake.params.cells,
        count=snakemake.params.placements,
        progress=log_progress("placements"),
        window=window and Window.from_dict(window).box,
        sampling=Sampling.from_dict(snakemake.params.sampling),
    )
    stability = map_stability(table, name=name, target=target)
    write_csv(Path(snakemake.output.placements), table)
    write_csv(Path(snakemake.output.spread), measure_spread(table, name=name, target=target))
    write_csv(Path(snakemake.output.stability), stability)
    write_csv(Path(snakemake.output.recommended), recommend_grid(stability, table))
