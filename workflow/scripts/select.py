from pathlib import Path

import pandas as pd

from provenance.record import recorded
from tusqh.atomic import write_text
from tusqh.geometry.canonical import load_geometry
from tusqh.hashing import canonical_json
from tusqh.pipeline.select import select
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
    fractions = load_fractions(Path(snakemake.input.fractions))
    curves, diagram = pd.read_csv(snakemake.input.curves), pd.read_csv(snakemake.input.diagram)
    window = snakemake.params.window
    reference = find_reference(
        load_geometry(Path(snakemake.input.geometry)),
        fractions,
        sampling=Sampling.from_dict(snakemake.params.sampling),
        window=window and Window.from_dict(window).box,
    )
    goal, name = Goal.from_dict(snakemake.params.goal), snakemake.wildcards.model
    choice = select(
        fractions,
        Topology.from_tables(fractions.multiples, curves, place_pairs(diagram, fractions.grid)),
        policy=Policy.from_dict(snakemake.params.policy),
        goal=goal,
        reference=reference,
        name=name,
    )
    selection, topologies = choice.selection, choice.topologies
    log.info(
        "%d plateaus examined; the filtration agrees at %d",
        len(topologies),
        topologies["raw_agrees"].sum(),
    )
    log.info("threshold %.6g: %s", selection.threshold, selection.reason)
    if selection.without_features:
        log.info(
            "the same topology without removing or filling any feature: %s",
            selection.without_features,
        )
    write_csv(Path(snakemake.output.topologies), topologies)
    write_csv(Path(snakemake.output.candidates), choice.candidates)
    write_csv(Path(snakemake.output.prices), choice.prices)
    write_text(Path(snakemake.output.selection), canonical_json(selection.to_dict()))
    # The paper's studies rest on one threshold for the whole model.
    one = choice.with_one_threshold(goal, name=name)
    write_text(Path(snakemake.output.one_threshold), canonical_json(one.to_dict()))
