from pathlib import Path

import pandas as pd

from provenance.record import recorded
from studies.figures.aliasing import draw_axis_gap, draw_examples
from tusqh.figures import style

with recorded(snakemake) as log:
    tables = {name: pd.read_csv(path) for name, path in snakemake.input.items()}
    examples = draw_examples(tables["examples"], tables["shapes"])
    style.save(examples, Path(snakemake.output.examples))
    axis_gap = draw_axis_gap(tables["axis_gap"], tables["axis_gap_shapes"])
    style.save(axis_gap, Path(snakemake.output.axis_gap))
