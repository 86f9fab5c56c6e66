from pathlib import Path

from provenance.record import recorded
from tusqh.antialias.scheme import PINCH_TEMPLATES
from tusqh.meshes.checks import Check
from tusqh.meshes.export import read_vtu
from tusqh.pipeline.fit import read_facts
from tusqh.pipeline.judge import judge
from tusqh.quality.fit_checks import FITTED
from tusqh.tables import write_csv
from tusqh.topology.betti_numbers import BettiNumbers

with recorded(snakemake) as log:
    fit = snakemake.input.fit
    source = Path([snakemake.input.mesh, *snakemake.input.fitted][-1])
    mesh = read_vtu(source, name=snakemake.wildcards.model)
    facts = read_facts(Path(snakemake.input.facts), *map(Path, fit))
    comparison = [Check(**check) for check in facts["comparison"]]
    predicted = BettiNumbers(*facts["betti_predicted"])
    checks = snakemake.params.quality.get("checks")
    scheme = FITTED if fit else PINCH_TEMPLATES
    judgement = judge(mesh, predicted, comparison=comparison, checks=checks, scheme=scheme)
    log.info("%s", judgement)
    write_csv(Path(snakemake.output.elements), judgement.elements)
    write_csv(Path(snakemake.output.verdict), judgement.verdict)
