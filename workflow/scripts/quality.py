import json
from pathlib import Path

from tusqh.meshes.export import read_vtu
from tusqh.provenance.record import recorded
from tusqh.quality.elements import element_metrics, summarise_metrics
from tusqh.quality.verdict import judge_mesh, overall, to_table
from tusqh.tables import write_csv
from tusqh.topology.betti_numbers import BettiNumbers

with recorded(snakemake) as log:
    mesh = read_vtu(Path(snakemake.input.mesh), name=snakemake.wildcards.model)
    facts = json.loads(Path(snakemake.input.facts).read_text())
    metrics = element_metrics(mesh)
    verdict = to_table(judge_mesh(mesh, BettiNumbers(*facts["betti_predicted"]), metrics))
    log.info("%s", overall(verdict))
    write_csv(Path(snakemake.output.elements), summarise_metrics(metrics))
    write_csv(Path(snakemake.output.verdict), verdict)
