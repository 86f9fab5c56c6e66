import json
from pathlib import Path

import pandas as pd

from provenance.record import recorded
from studies.peers import run_peer
from tusqh.geometry.canonical import load_geometry
from tusqh.sampling.io import load_fractions
from tusqh.settings.policy import Policy
from tusqh.settings.sampling import Sampling
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    selection = json.loads(Path(snakemake.input.selection).read_text())
    row, timing = run_peer(
        snakemake.wildcards.peer,
        load_geometry(Path(snakemake.input.geometry)),
        load_fractions(Path(snakemake.input.fractions)),
        Policy.from_dict(selection["policy"]),
        threshold=selection["threshold"],
        is_clamped=Sampling.from_dict(snakemake.params.sampling).rule == "clamped",
        seconds=snakemake.params.seconds,
        name=snakemake.wildcards.model,
    )
    log.info("%(peer)s: %(status)s, %(processor_seconds)s s of processor time", timing)
    write_csv(Path(snakemake.output.row), pd.DataFrame([row]))
    write_csv(Path(snakemake.output.timing), pd.DataFrame([timing]))
