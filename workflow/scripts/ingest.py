from pathlib import Path

from tusqh.geometry.defects import describe_defects
from tusqh.geometry.io import write_outline
from tusqh.geometry.read import read_outline
from tusqh.provenance.record import recorded
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    outline = read_outline(Path(snakemake.input.geometry))
    log.info("%d segments in %d chains", outline.n_segments, len(set(outline.chains.tolist())))
    defects = describe_defects(outline)
    write_outline(Path(snakemake.output.geometry), outline)
    write_csv(Path(snakemake.output.defects), defects)
