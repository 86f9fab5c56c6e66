import json
from pathlib import Path

import pandas as pd

from provenance.record import recorded
from studies.spread import pool_spreads
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    models = snakemake.params.models
    chosen = [json.loads(Path(p).read_text())["threshold"] for p in snakemake.input.selection]
    thresholds = dict(zip(models, chosen, strict=True))
    tables = dict(zip(models, map(pd.read_csv, snakemake.input.placements), strict=True))
    spread = pd.concat(map(pd.read_csv, snakemake.input.spreads), ignore_index=True)
    spread.insert(3, "is_chosen", spread["threshold"] == spread["model"].map(thresholds))
    finest = spread.groupby("model")["cells"].transform("max")
    spread.insert(4, "is_finest", spread["cells"] == finest)
    write_csv(Path(snakemake.output.spread), spread)
    pooled = {"chosen": thresholds, "one half": dict.fromkeys(models, 0.5)}
    pooled = {choice: pool_spreads(tables, at) for choice, at in pooled.items()}
    pooled = pd.concat(pooled, names=["choice"]).reset_index(level="choice")
    n_placements = next(iter(tables.values()))["placement"].nunique()
    pooled.insert(0, "placements", n_placements)
    write_csv(Path(snakemake.output.pooled), pooled)
    for kind in ("stability", "recommended"):
        files = snakemake.input["stabilities" if kind == "stability" else kind]
        table = pd.concat(map(pd.read_csv, files), ignore_index=True)
        write_csv(Path(snakemake.output[kind]), table)
