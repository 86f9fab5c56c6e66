from pathlib import Path

import pandas as pd

from provenance.record import recorded
from tusqh.pipeline.fit import read_facts
from tusqh.quality.summary import facts_of_materials, summarise_verdict
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    given, params = snakemake.input, snakemake.params
    fits = {Path(path).parent: [Path(path)] for path in given.fits}
    paths = map(Path, [*given.facts, *given.slabs_facts])
    facts = [read_facts(path, *fits.get(path.parent, [])) for path in paths]
    facts += [
        facts_of_materials(Path(path).parent.name, pd.read_csv(path))
        for path in given.assembly_materials
    ]
    of_verdicts = [*given.verdict, *given.slabs_verdict, *given.assembly_verdict]
    verdicts = [pd.read_csv(path) for path in of_verdicts]
    files = [*params.files, *params.files_of_assemblies]
    table = pd.DataFrame(
        summarise_verdict(about, verdict, file=file)
        for file, about, verdict in zip(files, facts, verdicts, strict=True)
    )
    log.info("%d of %d meshes have warnings", (table["warnings"] != "").sum(), len(table))
    write_csv(Path(snakemake.output.verdicts), table)
