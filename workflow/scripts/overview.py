from pathlib import Path

import pandas as pd

from tusqh.atomic import write_text
from tusqh.overview.model import ModelFiles, read_model
from tusqh.overview.page import render_overview
from tusqh.provenance.record import recorded

OF_MODEL = ("certificate", "facts", "defects", "candidates", "verdict", "verification", "record")

with recorded(snakemake) as log:
    given = snakemake.input
    register = pd.read_csv(given.register[0]) if given.register else None
    page = Path(snakemake.output.page)
    models = []
    for name, *files in zip(snakemake.params.models, *(given[k] for k in OF_MODEL), strict=True):
        folder = page.parent.parent / name
        links = {file: folder / path for file, path in snakemake.params.links.items()}
        figures = [Path(path) for path in given.figures if folder in Path(path).parents]
        of_model = ModelFiles(*map(Path, files), figures=figures, links=links)
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
