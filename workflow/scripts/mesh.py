from pathlib import Path

from provenance.record import recorded
from tusqh.geometry.canonical import load_geometry
from tusqh.pipeline.build import build
from tusqh.sampling.io import load_fractions
from tusqh.sampling.reference import find_reference
from tusqh.settings.grid import Window
from tusqh.settings.quality import Quality
from tusqh.settings.sampling import Sampling
from tusqh.threshold.selection import load_selection

WRITTEN = ("mesh", "certificate", "features", "bridges", "facts")

with recorded(snakemake) as log:
    fractions = Path(snakemake.input.fractions)
    selection = load_selection(Path(snakemake.input.selection))
    sampled = load_fractions(fractions)
    geometry = load_geometry(Path(snakemake.input.geometry))
    window = snakemake.params.window
    reference = find_reference(
        geometry,
        sampled,
        sampling=Sampling.from_dict(snakemake.params.sampling),
        window=window and Window.from_dict(window).box,
    )
    built = build(
        sampled,
        selection,
        name=snakemake.wildcards.model,
        geometry=geometry,
        reference=reference,
        tolerance=Quality.from_dict(snakemake.params.quality).volume_tolerance,
    )
    log.info("%(elements)d elements, Betti numbers %(betti_measured)s", built.facts)
    built.write(fractions=fractions, **{name: Path(snakemake.output[name]) for name in WRITTEN})
