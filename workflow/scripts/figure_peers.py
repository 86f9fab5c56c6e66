from pathlib import Path

import pandas as pd

from provenance.record import recorded
from studies.figures.peers import draw_peers
from tusqh.figures import style

with recorded(snakemake) as log:
    style.save(draw_peers(pd.read_csv(snakemake.input.table)), Path(snakemake.output.figure))
