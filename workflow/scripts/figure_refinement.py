from pathlib import Path

import pandas as pd

from provenance.record import recorded
from studies.figures.refinement import draw_two_triangles, draw_wedge_islands
from studies.wedge_islands import DEGREES
from tusqh.figures import style

with recorded(snakemake) as log:
    tables = {name: pd.read_csv(path) for name, path in snakemake.input.items()}
    blocks = draw_two_triangles(tables["two_triangles"], tables["two_triangles_shapes"])
    style.save(blocks, Path(snakemake.output.two_triangles))
    wedge = draw_wedge_islands(tables["wedge_components"], tables["wedge_grids"], degrees=DEGREES)
    style.save(wedge, Path(snakemake.output.wedge))
