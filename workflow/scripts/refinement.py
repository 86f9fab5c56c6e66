from pathlib import Path

from provenance.record import recorded
from studies.two_triangles import draw_refinements, refine
from studies.wedge_islands import follow_islands
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    write_csv(Path(snakemake.output.two_triangles), refine(snakemake.params.refinements))
    write_csv(Path(snakemake.output.two_triangles_shapes), draw_refinements())
    components, grids = follow_islands(snakemake.params.halvings)
    write_csv(Path(snakemake.output.wedge_components), components)
    write_csv(Path(snakemake.output.wedge_grids), grids)
