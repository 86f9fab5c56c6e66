from pathlib import Path

import pandas as pd

from provenance.record import recorded
from tusqh.atomic import write_text
from tusqh.overview.model import ModelFiles, read_model
from tusqh.overview.page import render_overview

OF_MODEL = ("certificate", "facts", "defects", "candidates", "verdict", "verification")

with recorded(snakemake) as log:
    given = snakemake.input
    register = pd.read_csv(given.register[0]) if given.register else None
    page = Path(snakemake.output.page)
    models = []
    sources = snakemake.params.models.items()
    for (name, geometry), *files in zip(sources, *(given[k] for k in OF_MODEL), strict=True):
        folder = page.parent.parent / name
        links = {title: folder / path for title, path in snakemake.params.links.items()}
        figures = [Path(path) for path in given.figures if folder in Path(path).parents]
        of_model = ModelFiles(geometry, *map(Path, files), figures=figures, links=links)
        models.append(read_model(of_model, register))
    log.info("%d of %d models hold", sum(model.holds for model in models), len(models))
    text = render_overview(
        page,
        models,
        tables={Path(path).stem.replace("_", " "): Path(path) for path in given.tables},
        figures={Path(path).stem.replace("_", " "): Path(path) for path in given.shared},
        captions=snakemake.params.captions,
    )
    write_text(page, text)
