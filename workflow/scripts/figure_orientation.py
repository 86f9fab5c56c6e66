from pathlib import Path

import pandas as pd

from tusqh.figures import style
from tusqh.figures.orientation import draw_orientation
from tusqh.provenance.record import recorded

with recorded(snakemake) as log:
    figure = draw_orientation(
        pd.read_csv(snakemake.input.spread), pd.read_csv(snakemake.input.pooled)
    )
    style.save(figure, Path(snakemake.output.figure))
