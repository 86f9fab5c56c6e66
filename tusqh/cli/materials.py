"""What `tusqh mesh --materials` prints and writes."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd
import typer

from tusqh.cli.show import show
from tusqh.settings.model import Settings


def mesh_and_show(geometry: str, outputs: list[Path], settings: Settings, *, as_json: bool) -> None:
    """Mesh an image of labels, write the mesh and print a row for every material.

    Parameters
    ----------
    geometry
        The image.
    outputs
        Mesh files to write.
    settings
        The settings of the command line.
    as_json
        Print JSON instead of a table.
    """
    from tusqh.pipeline.materials import mesh_label_file

    found = mesh_label_file(geometry, settings)
    for path in outputs:
        found.write(path)
    rows = [
        {
            "material": name,
            "elements": measured.mesh.n_cells,
            "volume": measured.volume,
            "predicted": str(found.predicted[name]),
            "measured": str(measured.by_euler),
        }
        for name, measured in found.measured.items()
    ]
    solid = found.measured_solid
    rows.append(
        {
            "material": "all",
            "elements": solid.mesh.n_cells,
            "volume": solid.volume,
            "predicted": str(found.predicted_solid),
            "measured": str(solid.by_euler),
        }
    )
    if as_json:
        facts = {"contacts": found.n_contacts, "overruled": found.n_overruled}
        typer.echo(json.dumps({"materials": rows, **facts}, indent=2))
    else:
        show(pd.DataFrame(rows), title=f"Materials of {found.mesh.name}")
        typer.echo(f"contacts {found.n_contacts}, votes overruled {found.n_overruled}")
        typer.echo("written  " + ", ".join(map(str, outputs)))
    if not found.is_as_predicted:
        raise typer.Exit(1)
