from pathlib import Path

import pandas as pd

from provenance.record import recorded
from studies.peers import compare_with_peers
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    table = pd.concat(map(pd.read_csv, snakemake.input.rows), ignore_index=True)
    betti = ["betti_0", "betti_1", "betti_2"]
    table = table.astype(dict.fromkeys(betti, "Int64"))
    write_csv(Path(snakemake.output.table), table)
    write_csv(Path(snakemake.output.summary), compare_with_peers(table))
    timing = pd.concat(map(pd.read_csv, snakemake.input.timings), ignore_index=True)
    write_csv(Path(snakemake.output.timing), timing.astype({"elements": "Int64"}))
