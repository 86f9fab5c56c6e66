from pathlib import Path

import pandas as pd

from provenance.record import recorded
from studies.figures.theorem import draw_map, draw_plane_gap, draw_windows
from tusqh.figures import style

with recorded(snakemake) as log:
    tables = {name: pd.read_csv(path) for name, path in snakemake.input.items()}
    windows = pd.concat([tables["windows"], tables["space_windows"]], ignore_index=True)
    style.save(draw_map(tables["sweep"], tables["orientations"]), Path(snakemake.output.map))
    style.save(draw_windows(windows), Path(snakemake.output.windows))
    style.save(draw_plane_gap(tables["space_orientations"]), Path(snakemake.output.space))
