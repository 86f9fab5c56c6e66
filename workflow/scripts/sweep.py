from pathlib import Path

import pandas as pd

from provenance.record import recorded
from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.meshes.export import write_vtu
from tusqh.quality.verification import verify_mesh
from tusqh.sampling.io import load_fractions
from tusqh.tables import write_csv
from tusqh.threshold.selection import load_selection

with recorded(snakemake) as log:
    fractions = load_fractions(Path(snakemake.input.fractions))
    cell_sets = CellSets(fractions, load_selection(Path(snakemake.input.selection)).policy)
    rows = []
    for path, threshold in zip(snakemake.output.meshes, snakemake.params.thresholds, strict=True):
        cells = cell_sets.at(threshold)
        resolved = build_mesh(cells, fractions.grid, name=snakemake.wildcards.model)
        write_vtu(Path(path), resolved.mesh)
        row = verify_mesh(resolved.mesh, cells, grid=fractions.grid.label)
        log.info("threshold %s: %s", threshold, "holds" if row["holds"] else "FAILS")
        rows.append(row)
    write_csv(Path(snakemake.output.verification), pd.DataFrame(rows))
