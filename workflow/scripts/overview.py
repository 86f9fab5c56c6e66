from pathlib import Path

import pandas as pd

from provenance.record import recorded
from tusqh.atomic import write_text
from tusqh.overview.materials import read_materials_model
from tusqh.overview.model import read_model
from tusqh.overview.page import render_overview

with recorded(snakemake) as log:
    given = snakemake.input
    register = pd.read_csv(given.register[0]) if given.register else None
    page = Path(snakemake.output.page)
    models = []
    for name, files in snakemake.params.models.items():
        folder = page.parent.parent / name
        figures = [Path(path) for path in given.figures if folder in Path(path).parents]
        shown = {"figures": figures, "register": register}
        if name in snakemake.params.of_materials:
            models.append(read_materials_model(folder, geometries=files, **shown))
        else:
            is_fitted = name in snakemake.params.fitted
            models.append(read_model(folder, geometry=files[0], fitted=is_fitted, **shown))
    log.info("%d of %d models hold", sum(model.holds for model in models), len(models))
    text = render_overview(
        page,
        models,
        tables={Path(path).stem.replace("_", " "): Path(path) for path in given.tables},
        figures={Path(path).stem.replace("_", " "): Path(path) for path in given.shared},
        captions=snakemake.params.captions,
    )
    write_text(page, text)
