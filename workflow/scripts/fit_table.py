from pathlib import Path

import pandas as pd

from provenance.record import recorded
from tusqh.files import TABLES_OF_ALL_MODELS
from tusqh.pipeline.fit import load_fit, read_facts
from tusqh.quality.summary import summarise_fit
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    given = snakemake.input
    rows = [
        summarise_fit(read_facts(Path(facts)), load_fit(Path(fit)), pd.read_csv(verdict))
        for facts, fit, verdict in zip(given.facts, given.fit, given.verdict, strict=True)
    ]
    columns = next(list(t.columns) for t in TABLES_OF_ALL_MODELS if t.name == "fit_table")
    table = pd.DataFrame(rows, columns=columns)
    log.info("%d models, %d with the same topology", len(table), table["betti_same"].sum())
    write_csv(Path(snakemake.output.fit), table)
    timings = [pd.DataFrame(columns=["model", "seconds", "peak_gb"])]
    timings += [pd.read_csv(path) for path in given.timings]
    write_csv(Path(snakemake.output.timing), pd.concat(timings, ignore_index=True))
