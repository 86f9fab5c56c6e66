from pathlib import Path

from provenance.record import recorded
from tusqh.meshes.export import read_vtu
from tusqh.progress import log_progress
from tusqh.simulate.diffusion import simulate_diffusion
from tusqh.simulate.settings import Simulation
from tusqh.simulate.snapshots import write_snapshots
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    model = snakemake.params.model
    mesh = read_vtu(Path(snakemake.input.mesh), name=snakemake.wildcards.model)
    result = simulate_diffusion(
        mesh,
        Simulation(**model["simulation"]),
        unit=model["unit"],
        steps=snakemake.params.steps,
        progress=log_progress("time steps"),
    )
    log.info("%d elements, %d unknowns", len(result.cells), result.fields.shape[1])
    files = [Path(path) for path in snakemake.output.snapshots]
    write_snapshots(Path(snakemake.output.collection), files, result)
    write_csv(Path(snakemake.output.table), result.table)
