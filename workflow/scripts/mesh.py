import json
from pathlib import Path

from tusqh.antialias.cells import CellSets
from tusqh.antialias.policy import Policy
from tusqh.antialias.resolve import build_mesh, describe_mesh
from tusqh.atomic import write_text
from tusqh.certificate import make_certificate
from tusqh.meshes.export import write_vtu
from tusqh.provenance.hashing import canonical_json
from tusqh.provenance.record import recorded
from tusqh.sampling.io import load_fractions
from tusqh.tables import write_csv
from tusqh.threshold.select import Selection

with recorded(snakemake) as log:
    fractions_file = Path(snakemake.input.fractions)
    fractions = load_fractions(fractions_file)
    selection = Selection.from_dict(json.loads(Path(snakemake.input.threshold).read_text()))
    policy = Policy.from_settings(selection.policy)
    cells = CellSets(fractions, policy).at(selection.threshold)
    name, mesh_file = snakemake.wildcards.model, Path(snakemake.output.mesh)
    resolved = build_mesh(cells, fractions.grid, name=name)
    facts = {
        "threshold": selection.threshold,
        "margin": selection.margin,
        **describe_mesh(resolved, fractions),
    }
    log.info("%(elements)d elements, Betti numbers %(betti_measured)s", facts)
    in_cell = fractions.cells.ravel()[resolved.mesh.grid_cell]
    write_vtu(mesh_file, resolved.mesh, cell_data={"volume_fraction": in_cell})
    certificate = make_certificate(selection, resolved.cells, mesh_file, fractions_file, name=name)
    write_csv(Path(snakemake.output.features), resolved.cells.dropped)
    write_csv(Path(snakemake.output.bridges), resolved.cells.bridge_table)
    write_text(Path(snakemake.output.certificate), canonical_json(certificate))
    write_text(Path(snakemake.output.facts), canonical_json(facts))
