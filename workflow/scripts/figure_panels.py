from pathlib import Path

import pandas as pd

from provenance.record import recorded
from tusqh.figures import style
from tusqh.figures.panels import draw_panels
from tusqh.geometry.canonical import load_geometry
from tusqh.meshes.export import read_vtu

with recorded(snakemake) as log:
    rows = pd.read_csv(snakemake.input.verification)
    meshes = [
        read_vtu(Path(path)) if n_elements else None
        for path, n_elements in zip(snakemake.input.meshes, rows["elements"], strict=True)
    ]
    figure = draw_panels(
        load_geometry(Path(snakemake.input.geometry)),
        meshes,
        rows["threshold"].tolist(),
        name=snakemake.wildcards.model,
    )
    style.save(figure, Path(snakemake.output.figure))
