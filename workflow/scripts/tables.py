import json
from pathlib import Path

import pandas as pd

from tusqh.provenance.record import recorded
from tusqh.tables import summary_row, write_csv, write_markdown

with recorded(snakemake) as log:
    files = zip(
        snakemake.input.facts, snakemake.input.verdicts, snakemake.input.masses, strict=True
    )
    summary = pd.DataFrame(
        summary_row(json.loads(Path(facts).read_text()), pd.read_csv(verdict), pd.read_csv(mass))
        for facts, verdict, mass in files
    )
    verification = pd.concat(map(pd.read_csv, snakemake.input.verifications), ignore_index=True)
    log.info(
        "%d of %d rows of the verification hold", verification["holds"].sum(), len(verification)
    )
    write_csv(Path(snakemake.output.summary), summary)
    write_markdown(Path(snakemake.output.markdown), summary)
    write_csv(Path(snakemake.output.verification), verification)
