from pathlib import Path

import pandas as pd

from provenance.record import recorded
from studies.suitability import summarise_iterations, summarise_suitability
from tusqh.tables import write_csv, write_markdown

with recorded(snakemake) as log:
    table = pd.concat(map(pd.read_csv, snakemake.input.tables), ignore_index=True)
    iterations = pd.concat(map(pd.read_csv, snakemake.input.iterations), ignore_index=True)
    summary = summarise_suitability(table)
    write_csv(Path(snakemake.output.table), table)
    write_csv(Path(snakemake.output.summary), summary)
    write_csv(Path(snakemake.output.iterations), summarise_iterations(iterations))
    write_markdown(Path(snakemake.output.markdown), summary)
