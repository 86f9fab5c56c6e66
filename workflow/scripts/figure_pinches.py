from pathlib import Path

from tusqh.figures import style
from tusqh.figures.pinches import draw_pinches
from tusqh.provenance.record import recorded

with recorded(snakemake) as log:
    style.save(draw_pinches(), Path(snakemake.output.figure))
