import json
from pathlib import Path

from provenance.record import recorded
from studies.orientation import (
    THRESHOLDS,
    map_stability,
    measure_spread,
    recommend_grid,
    vary_placement,
)
from tusqh.geometry.canonical import load_geometry
from tusqh.progress import log_progress
from tusqh.sampling.layout import to_window
from tusqh.settings.policy import Policy
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    selection = json.loads(Path(snakemake.input.selection).read_text())
    target = snakemake.params.wanted.get("target")
    name = snakemake.wildcards.model
    table = vary_placement(
        load_geometry(Path(snakemake.input.geometry)),
        Policy.from_dict(selection["policy"]),
        sorted({*THRESHOLDS, selection["threshold"]}),
        snakemake.params.cells,
        count=snakemake.params.placements,
        progress=log_progress("placements"),
        window=to_window(snakemake.params.window.get("window")),
        **snakemake.params.sampling,
    )
    stability = map_stability(table, name=name, target=target)
    write_csv(Path(snakemake.output.placements), table)
    write_csv(Path(snakemake.output.spread), measure_spread(table, name=name, target=target))
    write_csv(Path(snakemake.output.stability), stability)
    write_csv(Path(snakemake.output.recommended), recommend_grid(stability, table))
