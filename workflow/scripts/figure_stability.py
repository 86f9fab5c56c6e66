import json
from pathlib import Path

import pandas as pd

from tusqh.figures import style
from tusqh.figures.stability import draw_stability
from tusqh.provenance.record import recorded

with recorded(snakemake) as log:
    chosen = json.loads(Path(snakemake.input.threshold).read_text())
    figure = draw_stability(
        pd.read_csv(snakemake.input.stability),
        threshold=chosen["threshold"],
        name=snakemake.wildcards.model,
    )
    style.save(figure, Path(snakemake.output.figure))
