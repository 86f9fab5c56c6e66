import json
from pathlib import Path

from provenance.record import recorded
from studies.suitability import OWN_THRESHOLD, compare_suitability
from tusqh.antialias.cells import CellSets
from tusqh.sampling.io import load_fractions
from tusqh.settings.policy import Policy
from tusqh.tables import write_csv
from tusqh.threshold.select import Selection

with recorded(snakemake) as log:
    selection = Selection.from_dict(json.loads(Path(snakemake.input.selection).read_text()))
    fractions = load_fractions(Path(snakemake.input.fractions))
    table = compare_suitability(
        CellSets(fractions, Policy.from_dict(selection.policy)),
        {OWN_THRESHOLD: selection.threshold, "one half": 0.5},
        selection.predicted,
        name=snakemake.wildcards.model,
    )
    log.info("%d meshes, %d manifold", len(table), table["manifold"].sum())
    write_csv(Path(snakemake.output.table), table)
