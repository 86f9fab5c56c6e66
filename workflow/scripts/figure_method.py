from pathlib import Path

from tusqh.figures import style
from tusqh.figures.method import draw_method
from tusqh.provenance.record import recorded

with recorded(snakemake) as log:
    style.save(draw_method(), Path(snakemake.output.figure))
