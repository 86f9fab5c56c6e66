from dataclasses import asdict
from pathlib import Path

import pandas as pd

from tusqh.atomic import write_text
from tusqh.progress import log_progress
from tusqh.provenance.hashing import canonical_json
from tusqh.provenance.record import recorded
from tusqh.sampling.io import load_fractions
from tusqh.tables import write_csv
from tusqh.threshold.select import choose_threshold, predict_plateaus

with recorded(snakemake) as log:
    fractions = load_fractions(Path(snakemake.input.fractions))
    plateaus = pd.read_csv(snakemake.input.plateaus)
    how = snakemake.params.resolution
    topologies = predict_plateaus(fractions, plateaus, progress=log_progress("plateaus"), **how)
    selection, candidates = choose_threshold(
        fractions, topologies, name=snakemake.wildcards.model, **snakemake.params.wanted, **how
    )
    log.info("threshold %.6g: %s", selection.threshold, selection.reason)
    write_csv(Path(snakemake.output.topologies), topologies)
    write_csv(Path(snakemake.output.candidates), candidates)
    write_text(Path(snakemake.output.threshold), canonical_json(asdict(selection)))
