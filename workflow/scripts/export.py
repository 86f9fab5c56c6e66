from pathlib import Path

from provenance.record import recorded
from tusqh.meshes.export import read_regions, read_vtu
from tusqh.meshes.formats import Export, write_mesh

with recorded(snakemake) as log:
    source = Path([snakemake.input.mesh, *snakemake.input.fitted][-1])
    mesh, regions = read_vtu(source, name=snakemake.wildcards.model), read_regions(source)
    how = Export(is_smooth=len(snakemake.input.fitted) > 0)
    exports = [path for name, path in snakemake.output.items() if name.startswith("export_")]
    for path in exports:
        write_mesh(Path(path), mesh, regions, how)
        log.info("%s: %d bytes", path, Path(path).stat().st_size)
