from pathlib import Path

import pandas as pd

from tusqh.geometry.defects import describe_defects
from tusqh.geometry.files import locate, read_geometry, write_geometry
from tusqh.geometry.outline import Outline
from tusqh.geometry.surface_defects import describe_surface_defects
from tusqh.provenance.record import recorded
from tusqh.sampling.describe_winding import describe_winding
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    geometry = read_geometry(locate(snakemake.params.geometry))
    if isinstance(geometry, Outline):
        log.info("%d segments in %d chains", geometry.n_segments, len(set(geometry.chains)))
        defects = describe_defects(geometry)
    else:
        log.info("%d triangles in %d parts", len(geometry.triangles), len(set(geometry.parts)))
        defects = describe_surface_defects(geometry)
        defects = pd.concat([defects, describe_winding(geometry)], ignore_index=True)
    write_geometry(Path(snakemake.output.geometry), geometry)
    write_csv(Path(snakemake.output.defects), defects)
