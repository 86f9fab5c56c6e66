from pathlib import Path

import pandas as pd

from provenance.record import recorded
from studies.contacts import tabulate_contacts
from tusqh.sampling.io import load_fractions
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    tables = []
    for name, fractions, curves in zip(
        snakemake.params.models, snakemake.input.fractions, snakemake.input.curves, strict=True
    ):
        of_model = load_fractions(Path(fractions))
        thresholds = snakemake.params.sweep[of_model.grid.dim]
        tables.append(tabulate_contacts(of_model, pd.read_csv(curves), thresholds, name=name))
    contacts = pd.concat(tables, ignore_index=True)
    log.info(
        "%d contacts, %d overruled; %d of %d meshes have the topology of the diagram",
        contacts["pinches"].sum(),
        contacts["overruled"].sum(),
        contacts["equals_diagram"].sum(),
        len(contacts),
    )
    write_csv(Path(snakemake.output.table), contacts)
