from pathlib import Path

from provenance.record import recorded
from tusqh.pipeline.materials.mesh import mesh_several
from tusqh.settings.model import Model

with recorded(snakemake) as log:
    model = Model.from_dict(snakemake.params.model)
    found = mesh_several(
        model.geometry,
        model.settings,
        materials=model.list_of_materials or "parts",
        rest=model.rest,
        name=snakemake.wildcards.model,
    )
    for remark in found.remarks:
        log.info("%s", remark)
    log.info("%d elements, %d contacts", found.mesh.n_cells, found.built.n_contacts)
    found.save(Path(snakemake.output.mesh).parent)
