from pathlib import Path

from provenance.claims import evaluate_claims
from provenance.record import recorded
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    table = evaluate_claims(snakemake.params.claims, Path(), tables=set(snakemake.input.tables))
    for status, rows in table.groupby("status"):
        log.info("%s: %s", status, ", ".join(rows["id"]))
    write_csv(Path(snakemake.output.table), table)
