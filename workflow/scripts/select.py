from dataclasses import asdict
from pathlib import Path

import pandas as pd

from tusqh.antialias.cells import CellSets
from tusqh.antialias.policy import Policy
from tusqh.atomic import write_text
from tusqh.progress import log_progress
from tusqh.provenance.hashing import canonical_json
from tusqh.provenance.record import recorded
from tusqh.sampling.io import load_fractions
from tusqh.tables import write_csv
from tusqh.threshold.plateaus import predict_plateaus
from tusqh.threshold.select import choose_threshold

with recorded(snakemake) as log:
    policy = Policy.from_settings(snakemake.params.policy)
    cell_sets = CellSets(load_fractions(Path(snakemake.input.fractions)), policy)
    topologies = predict_plateaus(
        cell_sets, pd.read_csv(snakemake.input.plateaus), progress=log_progress("plateaus")
    )
    log.info(
        "%d of %d plateaus looked at; the raw filtration agrees at %d, clusters overruled at %d",
        len(topologies),
        len(cell_sets.levels),
        topologies["raw_agrees"].sum(),
        (topologies["overruled"] > 0).sum(),
    )
    selection, candidates = choose_threshold(
        cell_sets,
        topologies,
        pairs=pd.read_csv(snakemake.input.pairs),
        name=snakemake.wildcards.model,
        **snakemake.params.wanted,
    )
    log.info("threshold %.6g: %s", selection.threshold, selection.reason)
    if selection.without_features:
        log.info("the same topology with no feature dropped: %s", selection.without_features)
    write_csv(Path(snakemake.output.topologies), topologies)
    write_csv(Path(snakemake.output.candidates), candidates)
    write_text(Path(snakemake.output.threshold), canonical_json(asdict(selection)))
