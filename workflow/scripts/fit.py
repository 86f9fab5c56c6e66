import json
from pathlib import Path

import pandas as pd

from provenance.record import recorded
from tusqh.geometry.canonical import load_geometry
from tusqh.machine import Stopwatch
from tusqh.meshes.export import read_vtu
from tusqh.pipeline.fit import WRITTEN, fit
from tusqh.pipeline.original import Original
from tusqh.sampling.io import load_fractions
from tusqh.tables import write_csv
from tusqh.threshold.selection import load_selection

with recorded(snakemake) as log:
    given, watch = {name: Path(path) for name, path in snakemake.input.items()}, Stopwatch()
    result = fit(
        read_vtu(given["mesh"], name=snakemake.wildcards.model),
        load_selection(given["selection"]),
        load_fractions(given["fractions"]),
        Original.from_dict(load_geometry(given["geometry"]), snakemake.params),
        json.loads(given["facts"].read_text()),
    )
    timing = {"model": result.mesh.name, **watch.read()}
    write_csv(Path(snakemake.output.timing), pd.DataFrame([timing]))
    log.info("%(elements)d elements, %(fit)s", result.facts)
    result.write(mesh=given["mesh"], **{name: Path(snakemake.output[name]) for name in WRITTEN})
