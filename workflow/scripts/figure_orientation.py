from pathlib import Path

import pandas as pd

from provenance.record import recorded
from studies.figures.orientation import draw_orientation
from tusqh.figures import style

with recorded(snakemake) as log:
    figure = draw_orientation(
        pd.read_csv(snakemake.input.spread), pd.read_csv(snakemake.input.pooled)
    )
    style.save(figure, Path(snakemake.output.figure))
