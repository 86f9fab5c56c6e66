from pathlib import Path

from provenance.record import recorded
from tusqh.meshes.export import read_regions, read_vtu
from tusqh.progress import log_progress
from tusqh.settings.simulation import Simulation
from tusqh.simulate.diffusion import diffusivities_of, simulate_diffusion
from tusqh.simulate.snapshots import write_snapshots
from tusqh.tables import write_csv

with recorded(snakemake) as log:
    source = Path([snakemake.input.mesh, *snakemake.input.fitted][-1])
    simulation = Simulation.from_dict(snakemake.params.simulation)
    mesh = read_vtu(source, name=snakemake.wildcards.model)
    by_name = snakemake.params.diffusivities
    regions = read_regions(source) if by_name else None
    result = simulate_diffusion(
        mesh,
        simulation,
        diffusivities=regions and diffusivities_of(regions, by_name, simulation, dim=mesh.dim),
        steps=snakemake.params.steps,
        progress=log_progress("time steps"),
    )
    log.info("%d elements, %d unknowns", len(result.cells), result.fields.shape[1])
    files = [Path(path) for path in snakemake.output.snapshots]
    write_snapshots(Path(snakemake.output.simulation), files, result)
    write_csv(Path(snakemake.output.amount), result.table)
