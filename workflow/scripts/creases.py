from pathlib import Path

from provenance.record import recorded
from studies.creases import measure_creases
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    table = measure_creases(snakemake.params.solids, range(snakemake.params.rotations))
    log.info("%s", table.groupby("solid")[["captured", "path_max", "min_scaled_jacobian"]].min())
    write_csv(Path(snakemake.output.table), table)
