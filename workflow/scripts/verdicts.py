import json
from pathlib import Path

import pandas as pd

from provenance.record import recorded
from tusqh.quality.summary import summarise_verdict
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    files = zip(snakemake.params.files, snakemake.input.facts, snakemake.input.verdict, strict=True)
    table = pd.DataFrame(
        summarise_verdict(json.loads(Path(facts).read_text()), pd.read_csv(verdict), file=file)
        for file, facts, verdict in files
    )
    log.info("%d of %d meshes have warnings", (table["warnings"] != "").sum(), len(table))
    write_csv(Path(snakemake.output.verdicts), table)
