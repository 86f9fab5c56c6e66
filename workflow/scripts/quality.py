import json
from pathlib import Path

from provenance.record import recorded
from tusqh.meshes.checks import Check
from tusqh.meshes.export import read_vtu
from tusqh.pipeline.judge import judge
from tusqh.tables import write_csv
from tusqh.topology.betti_numbers import BettiNumbers

with recorded(snakemake) as log:
    mesh = read_vtu(Path(snakemake.input.mesh), name=snakemake.wildcards.model)
    facts = json.loads(Path(snakemake.input.facts).read_text())
    comparison = [Check(**check) for check in facts["comparison"]]
    predicted = BettiNumbers(*facts["betti_predicted"])
    checks = snakemake.params.quality.get("checks")
    judgement = judge(mesh, predicted, comparison=comparison, checks=checks)
    log.info("%s", judgement)
    write_csv(Path(snakemake.output.elements), judgement.elements)
    write_csv(Path(snakemake.output.verdict), judgement.verdict)
