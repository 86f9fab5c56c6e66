import json
from pathlib import Path

import pandas as pd

from provenance.record import recorded
from tusqh.quality.summary import summarise_model
from tusqh.tables import write_csv, write_markdown

with recorded(snakemake) as log:
    kinds = ("facts", "verdict", "amount", "defects")
    of_models = zip(*(snakemake.input[kind] for kind in kinds), strict=True)
    summary = pd.DataFrame(
        summarise_model(json.loads(Path(facts).read_text()), *map(pd.read_csv, tables))
        for facts, *tables in of_models
    )
    files = [*snakemake.input.verification, *snakemake.input.materials]
    verification = pd.concat(map(pd.read_csv, files), ignore_index=True)
    log.info(
        "%d of %d rows of the verification hold", verification["holds"].sum(), len(verification)
    )
    write_csv(Path(snakemake.output.summary), summary)
    write_markdown(Path(snakemake.output.markdown), summary)
    write_csv(Path(snakemake.output.verification), verification)
