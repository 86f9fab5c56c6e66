from pathlib import Path

import pandas as pd

from provenance.record import recorded
from tusqh.files import RESULT_FILES
from tusqh.pipeline.fit import read_facts
from tusqh.quality.summary import summarise_materials, summarise_model
from tusqh.tables import write_csv, write_markdown

with recorded(snakemake) as log:
    given = snakemake.input
    kinds = ("facts", "verdict", "amount", "defects")
    fits = {Path(path).parent: [Path(path)] for path in given.fits}
    rows, local = [], []
    for path, *tables in zip(*(given[kind] for kind in kinds), strict=True):
        facts = read_facts(Path(path), *fits.get(Path(path).parent, []))
        rows.append(summarise_model(facts, *map(pd.read_csv, tables)))
        local += [facts["verification"]] if "verification" in facts else []
    kinds = ("slabs_facts", "slabs_verdict", "slabs_defects")
    for path, verdict, defects in zip(*(given[kind] for kind in kinds), strict=True):
        facts = read_facts(Path(path))
        rows.append(summarise_model(facts, pd.read_csv(verdict), None, pd.read_csv(defects)))
    amounts = {Path(path).parents[1]: pd.read_csv(path) for path in given.assembly_amount}
    kinds = ("assembly_materials", "assembly_verification", "assembly_verdict")
    for files in zip(*(given[kind] for kind in kinds), strict=True):
        tables = [pd.read_csv(path, dtype={"material": str}) for path in files]
        rows += summarise_materials(*tables, amounts.get(Path(files[0]).parent))
    summary = pd.DataFrame(rows)
    files = [*given.verification, *given.assembly_verification]
    verification = pd.concat([*map(pd.read_csv, files), pd.DataFrame(local)], ignore_index=True)
    if verification.empty:  # Models in slabs alone are not swept.
        verification = pd.DataFrame(columns=[*RESULT_FILES["verification"].columns])
    log.info(
        "%d of %d rows of the verification hold", verification["holds"].sum(), len(verification)
    )
    write_csv(Path(snakemake.output.summary), summary)
    write_markdown(Path(snakemake.output.markdown), summary)
    write_csv(Path(snakemake.output.verification), verification)
