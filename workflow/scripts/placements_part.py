from pathlib import Path

from provenance.record import recorded
from studies.orientation import vary_model
from tusqh.tables import write_csv

with recorded(snakemake):
    table = vary_model(
        Path(snakemake.input.geometry),
        Path(snakemake.input.selection),
        snakemake.params.cells,
        count=snakemake.params.placements,
        part=(int(snakemake.wildcards.part), snakemake.params.n_parts),
        window=snakemake.params.window,
        sampling=snakemake.params.sampling,
    )
    write_csv(Path(snakemake.output.placements), table)
