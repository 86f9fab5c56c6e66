from pathlib import Path

import pandas as pd

from provenance.record import recorded
from studies.figures.scopes import draw_scopes
from tusqh.figures import style
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    table = pd.concat(map(pd.read_csv, snakemake.input.tables), ignore_index=True)
    log.info("%d of %d meshes have their target", table["holds"].sum(), len(table))
    write_csv(Path(snakemake.output.table), table)
    style.save(draw_scopes(table), Path(snakemake.output.figure))
