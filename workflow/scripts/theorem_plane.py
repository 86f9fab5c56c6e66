from pathlib import Path

import numpy as np

from provenance.record import recorded
from studies.contradictions import list_contradictions
from studies.directions import rotations
from studies.theorem import sweep_methods
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    low, high, step = snakemake.params.widths
    widths = np.linspace(low, high, round((high - low) / step) + 1).round(6)
    offsets = np.arange(snakemake.params.offsets) / snakemake.params.offsets
    places = rotations(snakemake.params.rotation_step)
    orientations, sweep, windows = sweep_methods(places, offsets, widths)
    contradictions = list_contradictions(sweep)
    write_csv(Path(snakemake.output.orientations), orientations.round(9))
    write_csv(Path(snakemake.output.sweep), sweep)
    write_csv(Path(snakemake.output.windows), windows)
    write_csv(Path(snakemake.output.contradictions), contradictions)
    log.info("%d of %d points contradict the theorem", len(contradictions), len(sweep))
