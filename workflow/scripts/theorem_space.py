from pathlib import Path

import numpy as np

from provenance.record import recorded
from studies.directions import plane_normals
from studies.theorem import sweep_methods
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    low, high, step = snakemake.params.widths
    widths = np.linspace(low, high, round((high - low) / step) + 1).round(6)
    offsets = np.arange(snakemake.params.offsets) / snakemake.params.offsets
    places = plane_normals(snakemake.params.ratios)
    orientations, sweep, windows = sweep_methods(places, offsets, widths)
    write_csv(Path(snakemake.output.orientations), orientations.round(9))
    write_csv(Path(snakemake.output.sweep), sweep)
    write_csv(Path(snakemake.output.windows), windows)
