import json
from pathlib import Path

import pandas as pd

from provenance.record import recorded
from tusqh.figures import style
from tusqh.figures.curves import draw_curves

with recorded(snakemake) as log:
    chosen = json.loads(Path(snakemake.input.selection).read_text())
    figure = draw_curves(
        pd.read_csv(snakemake.input.curves),
        pd.read_csv(snakemake.input.topologies),
        threshold=chosen["threshold"],
        interval=(chosen["lower"], chosen["upper"]),
        wanted=chosen["wanted"],
        name=snakemake.wildcards.model,
    )
    style.save(figure, Path(snakemake.output.figure))
