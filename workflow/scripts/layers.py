from pathlib import Path

from provenance.record import recorded
from studies.layers import compare_layers
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    table = compare_layers()
    log.info("largest error of a wall %.1e", table[table["case"] == "wall"]["error"].max())
    write_csv(Path(snakemake.output.table), table)
