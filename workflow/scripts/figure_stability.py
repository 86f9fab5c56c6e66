import json
from pathlib import Path

import pandas as pd

from provenance.record import recorded
from studies.figures.stability import draw_stability
from tusqh.figures import style

with recorded(snakemake) as log:
    chosen = json.loads(Path(snakemake.input.selection).read_text())
    figure = draw_stability(
        pd.read_csv(snakemake.input.stability),
        threshold=chosen["threshold"],
        name=snakemake.wildcards.model,
    )
    style.save(figure, Path(snakemake.output.figure))
