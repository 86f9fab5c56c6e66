import json
from pathlib import Path

import pandas as pd

from provenance.record import recorded
from tusqh.figures import style
from tusqh.figures.diagram import draw_diagram

with recorded(snakemake) as log:
    figure = draw_diagram(
        pd.read_csv(snakemake.input.diagram),
        pd.read_csv(snakemake.input.diagonal),
        threshold=json.loads(Path(snakemake.input.selection).read_text())["threshold"],
        name=snakemake.wildcards.model,
    )
    style.save(figure, Path(snakemake.output.figure))
