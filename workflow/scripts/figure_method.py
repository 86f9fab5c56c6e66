from pathlib import Path

from provenance.record import recorded
from studies.figures.method import draw_method
from tusqh.figures import style

with recorded(snakemake) as log:
    style.save(draw_method(), Path(snakemake.output.figure))
