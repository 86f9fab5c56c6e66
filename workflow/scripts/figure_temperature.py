from pathlib import Path

import pandas as pd

from provenance.record import recorded
from tusqh.figures import style
from tusqh.figures.temperature import draw_temperature
from tusqh.simulate.snapshots import read_snapshot

with recorded(snakemake) as log:
    snapshots = [read_snapshot(Path(path)) for path in snakemake.input.snapshots]
    points, cells, _ = snapshots[0]
    figure = draw_temperature(
        points,
        cells,
        [field for _, _, field in snapshots],
        pd.read_csv(snakemake.input.amount),
        name=snakemake.wildcards.model,
    )
    style.save(figure, Path(snakemake.output.figure))
