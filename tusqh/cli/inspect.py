"""`tusqh inspect`: what is dirty about a geometry."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import pandas as pd
import typer

from tusqh.cli.show import show


def inspect(
    geometry: Annotated[
        Path, typer.Argument(help="GeoJSON, SVG, DXF, CSV; STL, OBJ, PLY, OFF, GLB, VTK.")
    ],
) -> None:
    """Measure the defects of a geometry file; nothing is repaired.

    Example: tusqh inspect data_sources/chesapeake/counties.geojson
    """
    from tusqh.geometry.defects import describe_defects
    from tusqh.geometry.files import read_geometry
    from tusqh.geometry.outline import Outline
    from tusqh.geometry.surface_defects import describe_surface_defects
    from tusqh.sampling.describe_winding import describe_winding

    found = read_geometry(geometry)
    if isinstance(found, Outline):
        table = describe_defects(found)
    else:
        table = pd.concat([describe_surface_defects(found), describe_winding(found)])
    show(table, title=f"Defects of {geometry.name}")
