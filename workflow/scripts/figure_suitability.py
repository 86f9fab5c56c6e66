from pathlib import Path

import pandas as pd

from tusqh.figures import style
from tusqh.figures.suitability import draw_suitability
from tusqh.provenance.record import recorded

with recorded(snakemake) as log:
    figure = draw_suitability(pd.read_csv(snakemake.input.table))
    style.save(figure, Path(snakemake.output.figure))
