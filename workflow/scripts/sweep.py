from pathlib import Path

import pandas as pd

from tusqh.antialias.resolve import keep_cells, resolve
from tusqh.mesh.export import write_vtu
from tusqh.provenance.record import recorded
from tusqh.sampling.io import load_fractions
from tusqh.tables import verification_row, write_csv

with recorded(snakemake) as log:
    fractions = load_fractions(Path(snakemake.input.fractions))
    model, rows = snakemake.wildcards.model, []
    for path, threshold in zip(snakemake.output.meshes, snakemake.params.thresholds, strict=True):
        cells = keep_cells(fractions, threshold=threshold, **snakemake.params.resolution)
        mesh, _ = resolve(cells.kept, cells.decisions, fractions.grid, name=model)
        write_vtu(Path(path), mesh)
        row = verification_row(mesh, cells, grid=fractions.grid.label, threshold=threshold)
        log.info("threshold %s: %s", threshold, "holds" if row["holds"] else "FAILS")
        rows.append(row)
    write_csv(Path(snakemake.output.rows), pd.DataFrame(rows))
