"""`tusqh inspect`: what is dirty about a geometry, and which topologies it can have."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, cast

import typer
from rich.console import Console

from tusqh.cli import options
from tusqh.cli.progress import shown
from tusqh.cli.show import show

if TYPE_CHECKING:
    import pandas as pd

#: So many intervals of the threshold are listed, the widest ones.
_ROWS = 12


def inspect(
    geometry: options.Source,
    cells: options.Cells = None,
    cell_size: options.CellSize = None,
    window: options.Window = None,
    domain: options.Domain = "inside",
    samples: options.Samples = 4,
    rule: options.Rule = "average",
    sampler: options.Sampler = "crossings",
    tolerance: options.Tolerance = 1e-6,
    orientation: options.Orientation = "auto",
    min_cells: options.MinCells = None,
    voxel_size: options.VoxelSize = None,
    empty: options.Empty = None,
    full: options.Full = None,
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
    from tusqh.pipeline.ingest import describe_geometry, ingest
    from tusqh.pipeline.persistence import find_persistence
    from tusqh.pipeline.sample import sample
    from tusqh.pipeline.select import predict
    from tusqh.pipeline.settings import POLICY, SAMPLING, pick, to_settings

    settings = to_settings(
        cells=cells,
        cell_size=cell_size,
        window=window,
        domain=domain,
        samples=samples,
        rule=rule,
        sampler=sampler,
        tolerance=tolerance,
        orientation=orientation,
        components=None if min_cells is None else {"min_cells": min_cells},
        image=options.to_image(voxel_size, empty, full),
    )
    found = ingest(geometry, image=settings.get("image"))
    show(describe_geometry(found), title=f"Defects of {found.name}")
    if defects_only:
        return
    with shown() as progress:
        fractions = sample(
            found, **pick(settings, ("grid", "window", *SAMPLING)), progress=progress
        )
        progress("persistence")
        curves = find_persistence(fractions, name=found.name).curves
        _, topologies = predict(fractions, curves, policy=pick(settings, POLICY), progress=progress)
    table, n_more = _list_topologies(topologies, every=every)
    show(table, title=f"Topologies on {fractions.grid.label} cells, by threshold t")
    if n_more:
        Console().print(f"{n_more} narrower intervals are not shown; --all lists them")


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
