from pathlib import Path

from tusqh.geometry.files import load_geometry
from tusqh.progress import log_progress
from tusqh.provenance.record import recorded
from tusqh.sampling.fractions import require_memory, sample_fractions
from tusqh.sampling.io import save_fractions
from tusqh.sampling.layout import lay_grid, to_window

with recorded(snakemake) as log:
    geometry = load_geometry(Path(snakemake.input.geometry))
    window = to_window(snakemake.params.grid.get("window"))
    grid = lay_grid(geometry, window, **snakemake.params.grid["grid"])
    require_memory(grid, "meshing", name=geometry.name)
    log.info("%s cells of size %g", grid.label, grid.cell_size)
    fractions = sample_fractions(
        geometry, grid, window=window, progress=log_progress("samples"), **snakemake.params.sampling
    )
    save_fractions(Path(snakemake.output.fractions), fractions)
