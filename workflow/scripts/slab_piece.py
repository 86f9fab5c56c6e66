from pathlib import Path

from provenance.record import recorded
from tusqh.pipeline.slabs.steps import read_layout, write_piece_of

with recorded(snakemake):
    piece = Path(snakemake.output.piece)
    layout = read_layout(Path(snakemake.input.slab_grid))
    write_piece_of(layout, piece.parents[1], int(snakemake.wildcards.slab), piece)
