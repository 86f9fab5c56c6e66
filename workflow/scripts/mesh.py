import json
from pathlib import Path

from tusqh.antialias.resolve import describe_mesh, keep_cells, resolve
from tusqh.atomic import write_text
from tusqh.mesh.export import write_vtu
from tusqh.provenance.hashing import canonical_json
from tusqh.provenance.record import recorded
from tusqh.sampling.io import load_fractions
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    fractions = load_fractions(Path(snakemake.input.fractions))
    selection = json.loads(Path(snakemake.input.threshold).read_text())
    how = snakemake.params.resolution
    cells = keep_cells(fractions, threshold=selection["threshold"], **how)
    mesh, n_rounds = resolve(
        cells.kept, cells.decisions, fractions.grid, name=snakemake.wildcards.model
    )
    facts = {**selection, **describe_mesh(mesh, cells, fractions.grid), "closing_rounds": n_rounds}
    log.info("%(elements)d elements, Betti numbers %(betti_measured)s", facts)
    in_cell = fractions.cells.ravel()[mesh.grid_cell]
    write_vtu(Path(snakemake.output.mesh), mesh, cell_data={"volume_fraction": in_cell})
    write_csv(Path(snakemake.output.removed), cells.removed)
    write_text(Path(snakemake.output.facts), canonical_json(facts))
