from pathlib import Path

import pandas as pd

from provenance.record import recorded
from studies.peers import run_peer
from tusqh.geometry.canonical import load_geometry
from tusqh.sampling.io import load_fractions
from tusqh.settings.grid import Grid, Window
from tusqh.settings.model import Settings
from tusqh.settings.sampling import Sampling
from tusqh.tables import write_csv
from tusqh.threshold.selection import load_selection

with recorded(snakemake) as log:
    window = snakemake.params.window
    row, timing = run_peer(
        snakemake.wildcards.peer,
        load_geometry(Path(snakemake.input.geometry)),
        load_fractions(Path(snakemake.input.fractions)),
        load_selection(Path(snakemake.input.selection)),
        settings=Settings(
            grid=Grid.from_dict(snakemake.params.grid),
            sampling=Sampling.from_dict(snakemake.params.sampling),
            window=window and Window.from_dict(window),
        ),
        seconds=snakemake.params.seconds,
        name=snakemake.wildcards.model,
    )
    log.info("%(peer)s: %(status)s, %(processor_seconds)s s of processor time", timing)
    write_csv(Path(snakemake.output.row), pd.DataFrame([row]))
    write_csv(Path(snakemake.output.timing), pd.DataFrame([timing]))
