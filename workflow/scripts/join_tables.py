from pathlib import Path

from provenance.record import recorded
from tusqh.tables import join_csv

with recorded(snakemake):
    join_csv(Path(snakemake.output[0]), [Path(path) for path in snakemake.input.rows])
