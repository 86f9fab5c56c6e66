from pathlib import Path

import pandas as pd

from provenance.record import recorded
from studies.figures.pinches import draw_catalogue, draw_panels
from tusqh.figures import style

with recorded(snakemake) as log:
    tables = {name: pd.read_csv(path) for name, path in snakemake.input.items()}
    style.save(
        draw_catalogue(tables["catalogue"], tables["elements"]), Path(snakemake.output.catalogue)
    )
    for name, columns, title in (
        ("series", 3, "Every pinch follows its own vote"),
        ("edges", 2, "Interior edges join components"),
    ):
        figure = draw_panels(tables[name], tables[f"{name}_shapes"], columns=columns, title=title)
        style.save(figure, Path(snakemake.output[name]))
