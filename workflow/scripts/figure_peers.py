from pathlib import Path

import pandas as pd

from tusqh.figures import style
from tusqh.figures.peers import draw_peers
from tusqh.provenance.record import recorded

with recorded(snakemake) as log:
    style.save(draw_peers(pd.read_csv(snakemake.input.table)), Path(snakemake.output.figure))
