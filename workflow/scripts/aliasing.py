from pathlib import Path

from provenance.record import recorded
from studies.aliasing import compare_examples, draw_axis_gaps, sweep_axis_gap
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    shapes, facts = compare_examples()
    write_csv(Path(snakemake.output.examples), facts)
    write_csv(Path(snakemake.output.shapes), shapes)
    write_csv(Path(snakemake.output.axis_gap), sweep_axis_gap(snakemake.params.offsets))
    write_csv(Path(snakemake.output.axis_gap_shapes), draw_axis_gaps())
