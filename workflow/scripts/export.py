from pathlib import Path

from provenance.record import recorded
from tusqh.geometry.canonical import load_geometry
from tusqh.meshes.choose_sets import write_table_of_sets
from tusqh.meshes.export import read_regions, read_vtu
from tusqh.meshes.formats import make_content, write_mesh
from tusqh.meshes.patches import read_patches
from tusqh.pipeline.exports import export_of

with recorded(snakemake) as log:
    given = snakemake.input
    fitted, of_patches = given.get("fitted", []), given.get("patches", [])
    source = Path([given.mesh, *fitted][-1])
    mesh, regions = read_vtu(source, name=snakemake.wildcards.model), read_regions(source)
    source_of_sets = given.get("geometry")
    geometry = load_geometry(Path(source_of_sets)) if source_of_sets else None
    patch = next((read_patches(Path(path), mesh) for path in of_patches), None)
    how = export_of(mesh, geometry, is_fitted=bool(fitted), patch=patch)
    exports = [path for name, path in snakemake.output.items() if name.startswith("export_")]
    for path in exports:
        write_mesh(Path(path), mesh, regions, how)
        log.info("%s: %d bytes", path, Path(path).stat().st_size)
    content = make_content(mesh, regions, how)
    write_table_of_sets(Path(snakemake.output.sets), content.mesh, content.sets)
