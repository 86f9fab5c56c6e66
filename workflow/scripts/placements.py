from pathlib import Path

import pandas as pd

from provenance.record import recorded
from studies.orientation import vary_model
from studies.spread import measure_spread
from studies.stability import map_stability, recommend_grid
from tusqh.settings.goal import Goal
from tusqh.tables import write_csv

with recorded(snakemake):
    target = Goal.from_dict(snakemake.params.goal).target
    name = snakemake.wildcards.model
    if snakemake.input.parts:
        parts = [pd.read_csv(p, float_precision="round_trip") for p in snakemake.input.parts]
        table = pd.concat(parts, ignore_index=True)
    else:
        table = vary_model(
            Path(snakemake.input.geometry),
            Path(snakemake.input.selection),
            snakemake.params.cells,
            count=snakemake.params.placements,
            window=snakemake.params.window,
            sampling=snakemake.params.sampling,
        )
    stability = map_stability(table, name=name, target=target)
    write_csv(Path(snakemake.output.placements), table)
    write_csv(Path(snakemake.output.spread), measure_spread(table, name=name, target=target))
    write_csv(Path(snakemake.output.stability), stability)
    write_csv(Path(snakemake.output.recommended), recommend_grid(stability, table))
