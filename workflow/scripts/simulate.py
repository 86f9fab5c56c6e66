from pathlib import Path

from provenance.record import recorded
from tusqh.meshes.export import read_vtu
from tusqh.progress import log_progress
from tusqh.settings.simulation import Simulation
from tusqh.simulate.diffusion import simulate_diffusion
from tusqh.simulate.snapshots import write_snapshots
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    mesh = read_vtu(Path(snakemake.input.mesh), name=snakemake.wildcards.model)
    result = simulate_diffusion(
        mesh,
        Simulation.from_dict(snakemake.params.simulation),
        unit=snakemake.params.unit,
        steps=snakemake.params.steps,
        progress=log_progress("time steps"),
    )
    log.info("%d elements, %d unknowns", len(result.cells), result.fields.shape[1])
    files = [Path(path) for path in snakemake.output.snapshots]
    write_snapshots(Path(snakemake.output.simulation), files, result)
    write_csv(Path(snakemake.output.amount), result.table)
