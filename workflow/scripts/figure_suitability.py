from pathlib import Path

import pandas as pd

from provenance.record import recorded
from studies.figures.suitability import draw_suitability
from tusqh.figures import style

with recorded(snakemake) as log:
    figure = draw_suitability(pd.read_csv(snakemake.input.table))
    style.save(figure, Path(snakemake.output.figure))
