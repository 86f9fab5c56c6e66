from pathlib import Path

import pandas as pd

from provenance.record import recorded
from studies.scopes import compare_scopes
from tusqh.geometry.canonical import load_geometry
from tusqh.pipeline.select import find_plateaus
from tusqh.sampling.io import load_fractions
from tusqh.sampling.reference import find_reference
from tusqh.settings.goal import Goal
from tusqh.settings.grid import Window
from tusqh.settings.policy import Policy
from tusqh.settings.sampling import Sampling
from tusqh.tables import write_csv
from tusqh.topology.persistence import place_pairs
from tusqh.topology.topology import Topology

with recorded(snakemake) as log:
    params = snakemake.params
    geometry = load_geometry(Path(snakemake.input.geometry))
    fractions = load_fractions(Path(snakemake.input.fractions))
    curves, diagram = pd.read_csv(snakemake.input.curves), pd.read_csv(snakemake.input.diagram)
    sampling = Sampling.from_dict(params.sampling)
    box = params.window and Window.from_dict(params.window).box
    plateaus = find_plateaus(
        fractions,
        Topology.from_tables(fractions.multiples, curves, place_pairs(diagram, fractions.grid)),
        policy=Policy.from_dict(params.policy),
        reference=find_reference(geometry, fractions, sampling=sampling, window=box),
    )
    table = compare_scopes(
        plateaus,
        geometry,
        wanted=Goal.from_dict(params.goal).target,
        sampling=sampling,
        window=box,
        name=snakemake.wildcards.model,
    )
    log.info("%d of %d meshes have their target", table["holds"].sum(), len(table))
    write_csv(Path(snakemake.output.table), table)
