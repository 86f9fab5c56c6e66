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

#: Number of intervals of the threshold that are listed, the widest ones.
_ROWS = 12


@options.with_settings(without=("goal", "quality"))
def inspect(
    geometry: options.Source,
    *,
    settings: Settings,
    every: Annotated[
        bool, typer.Option("--all", help=f"List every interval, not the {_ROWS} widest.")
    ] = False,
    defects_only: Annotated[
        bool, typer.Option("--defects-only", help="Measure the defects and stop.")
    ] = False,
) -> None:
    """Measure the defects of a geometry, and list the topologies it can be meshed with.

    Nothing is repaired. The second table says for every interval of the threshold how many
    components, holes and voids the mesh would have; ask for one with tusqh mesh --betti.

    For example:

    * `tusqh inspect part.stl`

    * `tusqh inspect bay.geojson --domain outside --cells 60,79 --all`
    """
    from tusqh.pipeline.describe_reading import describe_reading, lines_of_reading
    from tusqh.pipeline.ingest import describe_geometry, read_source
    from tusqh.pipeline.sample import sample
    from tusqh.pipeline.select import find_plateaus
    from tusqh.pipeline.unused_settings import note_unused_settings

    reading = read_source(geometry, image=settings.image.to_dict())
    reading = note_unused_settings(reading, settings)
    found = reading.geometry
    for title, text in lines_of_reading(describe_reading(reading)).items():
        typer.echo(f"{title:<5} {text}")
    for remark in reading.remarks:
        typer.echo(str(remark))
    show(describe_geometry(found), title=f"Defects of {found.name}")
    if defects_only:
        return
    with shown() as progress:
        fractions = sample(
            found,
            grid=settings.grid,
            sampling=settings.sampling,
            window=settings.window,
            progress=progress,
        )
        topologies = find_plateaus(fractions, policy=settings.policy, progress=progress).table
    table, n_more = _list_topologies(topologies, every=every)
    show(table, title=f"Topologies on {fractions.grid.label} cells, by threshold t")
    if n_more:
        make_console().print(f"{n_more} narrower intervals are not shown; --all lists them")


def _list_topologies(topologies: pd.DataFrame, *, every: bool) -> tuple[pd.DataFrame, int]:
    """Return the intervals of the threshold from high to low, and how many were left out."""
    from tusqh.threshold.plateaus import merge_intervals

    intervals = merge_intervals(topologies)
    shown = intervals if every else intervals.nlargest(_ROWS, "width").sort_index()
    columns = {
        "lower": "lower <",
        "upper": "t <= upper",
        "width": "width",
        "cells": "cells",
        "betti_0": "components",
        "betti_1": "holes",
        "betti_2": "voids",
    }
    table = cast(Any, shown[list(columns)].rename(columns=columns))
    return table, len(intervals) - len(shown)
