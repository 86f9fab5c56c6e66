"""`tusqh inspect`: what is dirty about a geometry, and which topologies it can have."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from tusqh.cli import options
from tusqh.cli.progress import shown
from tusqh.cli.show import make_console, show
from tusqh.settings.model import Settings

if TYPE_CHECKING:
    import pandas as pd

    from tusqh.geometry.kinds import Surface

#: At most this many intervals of the threshold are listed, the best ones.
_ROWS = 10


@options.with_settings(
    without=(
        "goal.target",
        "goal.persistence",
        "goal.volume",
        "goal.scope",
        "goal.base",
        "quality",
        "memory",
    ),
)
def inspect(
    geometry: options.Source,
    *,
    settings: Settings,
    every: Annotated[
        bool, typer.Option("--all", help=f"List every interval, not the {_ROWS} best.")
    ] = False,
    defects_only: Annotated[
        bool, typer.Option("--defects-only", help="Measure the defects and stop.")
    ] = False,
) -> None:
    """Measure the defects of a geometry, and list the topologies it can be meshed with.

    Nothing is repaired. The second table says what would be inside by each --inside. The third
    says for every interval of the threshold how many components, holes and voids the mesh would
    have, and its volume over that of the geometry; ask for one with tusqh mesh --betti. Wide
    intervals with the right volume come first; the one at --threshold (1/2) is always listed.

    For example:

    * `tusqh inspect part.stl`

    * `tusqh inspect bay.geojson --domain outside --cells 60,79 --all`
    """
    from tusqh.geometry.image import Image
    from tusqh.pipeline.describe_reading import describe_reading, lines_of_reading
    from tusqh.pipeline.ingest import describe_geometry
    from tusqh.pipeline.sample import BASE_THRESHOLD, sample
    from tusqh.pipeline.select import find_plateaus
    from tusqh.pipeline.unused_settings import read_with
    from tusqh.sampling.reference import find_reference

    reading = read_with(geometry, settings)
    found = reading.geometry
    for title, text in lines_of_reading(describe_reading(reading)).items():
        typer.echo(f"{title:<5} {text}")
    for remark in reading.remarks:
        typer.echo(str(remark))
    show(describe_geometry(found), title=f"Defects of {found.name}")
    if defects_only:
        return
    if not isinstance(found, Image):
        _show_insides(found, settings)
    with shown() as progress:
        fractions = sample(
            found,
            grid=settings.grid,
            sampling=settings.sampling,
            window=settings.window,
            threshold=settings.goal.threshold,
            progress=progress,
        )
        box = None if settings.window is None else settings.window.box
        plateaus = find_plateaus(
            fractions,
            policy=settings.policy,
            reference=find_reference(found, fractions, sampling=settings.sampling, window=box),
            progress=progress,
        )
    base = settings.goal.threshold or BASE_THRESHOLD
    table, n_more = _list_topologies(plateaus.table, base, every=every)
    source = plateaus.reference.source
    show(table, title=f"Topologies on {fractions.grid.label} cells, by threshold t, best first")
    make_console().print(f"volume: of the kept cells over {source}; at: where t = {base:g} lies")
    if n_more:
        make_console().print(f"{n_more} more intervals are not shown; --all lists them")


def _show_insides(geometry: Surface, settings: Settings) -> None:
    """Show what each way to tell inside from outside gives."""
    from tusqh.pipeline.insides import COARSE, compare_insides

    table = compare_insides(geometry, settings)
    chosen = settings.sampling
    seal, thickness = chosen.seal or "half a cell", chosen.thickness or "one cell"
    table = table.astype(object).fillna("")
    show(table, title=f"What is inside, on {COARSE} cells along the longest side, at t = 1/2")
    make_console().print(
        f"--inside chooses; here {chosen.inside}. A ball {seal} wide makes the envelope (--seal), "
        f"the shell is {thickness} thick (--thickness)"
    )


def _list_topologies(
    topologies: pd.DataFrame, base: float, *, every: bool
) -> tuple[pd.DataFrame, int]:
    """Return the intervals of the threshold, the best first, and how many were left out."""
    from tusqh.threshold.candidates import rank_for_inspection

    intervals = rank_for_inspection(topologies, base)
    is_shown = (intervals["rank"] <= _ROWS) | every
    if not (is_shown & (intervals["at"] != "")).any():  # That one takes the place of the last.
        is_shown = (intervals["rank"] < _ROWS) | (intervals["at"] != "")
    shown = intervals[is_shown]
    columns = {
        "rank": "rank",
        "at": "at",
        "lower": "lower <",
        "upper": "t <= upper",
        "volume_ratio": "volume",
        "cells": "cells",
        "betti_0": "components",
        "betti_1": "holes",
        "betti_2": "voids",
    }
    table = cast(Any, shown[list(columns)].rename(columns=columns))
    return table, len(intervals) - len(shown)
