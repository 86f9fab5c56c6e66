from pathlib import Path

from provenance.record import recorded
from tusqh.meshes.export import read_vtu
from tusqh.meshes.formats import write_mesh

with recorded(snakemake) as log:
    mesh = read_vtu(Path(snakemake.input.mesh), name=snakemake.wildcards.model)
    exports = [path for name, path in snakemake.output.items() if name.startswith("export_")]
    for path in exports:
        write_mesh(Path(path), mesh)
        log.info("%s: %d bytes", path, Path(path).stat().st_size)
