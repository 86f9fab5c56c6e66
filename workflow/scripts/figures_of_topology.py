import json
from pathlib import Path

import pandas as pd

from provenance.record import recorded
from tusqh.figures import style
from tusqh.figures.curves import draw_curves
from tusqh.figures.diagram import draw_diagram

with recorded(snakemake) as log:
    chosen = json.loads(Path(snakemake.input.selection).read_text())
    diagram = draw_diagram(
        pd.read_csv(snakemake.input.diagram),
        pd.read_csv(snakemake.input.diagonal),
        threshold=chosen["threshold"],
        base=chosen["base"],
        name=snakemake.wildcards.model,
    )
    style.save(diagram, Path(snakemake.output.figure_diagram))
    curves = draw_curves(
        pd.read_csv(snakemake.input.curves),
        pd.read_csv(snakemake.input.topologies),
        threshold=chosen["threshold"],
        base=chosen["base"],
        interval=(chosen["lower"], chosen["upper"]),
        wanted=chosen["wanted"],
        name=snakemake.wildcards.model,
    )
    style.save(curves, Path(snakemake.output.figure_curves))
