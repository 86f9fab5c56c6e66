"""What `tusqh mesh --materials` prints and writes."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd
import typer

from tusqh.cli.show import show
from tusqh.errors import ConfigError
from tusqh.settings.model import Settings


def mesh_and_show(
    geometry: str,
    outputs: list[Path],
    results: Path | None,
    settings: Settings,
    *,
    as_json: bool,
) -> None:
    """Mesh an image of labels, write the mesh and print a row for every material.

    Parameters
    ----------
    geometry
        The image.
    outputs
        Mesh files to write.
    results
        Folder of results, which several materials do not have yet.
    settings
        The settings of the command line.
    as_json
        Print JSON instead of a table.

    Raises
    ------
    ConfigError
        A folder of results is asked for.
    """
    if results is not None:
        raise ConfigError(
            "--results together with --materials",
            where="tusqh mesh",
            expected="mesh files with -o",
            remedy="leave out --results",
        )
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
