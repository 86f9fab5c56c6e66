"""`tusqh add`: a new model for the workflow."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from tusqh.cli import options
from tusqh.cli.show import make_console
from tusqh.settings.model import Model, Settings


@options.with_settings(without=("memory",))
def add(
    geometry: options.Source,
    name: Annotated[
        str | None, typer.Option(help="The model. (default the name of the file)")
    ] = None,
    *,
    settings: Settings,
    licence: Annotated[str, typer.Option(help="Licence of the file.")] = "unknown",
    origin: Annotated[str, typer.Option(help="Where the file comes from, in words.")] = "",
    url: Annotated[str, typer.Option(help="Address from which it can be downloaded.")] = "",
    config: Annotated[Path, typer.Option(help="The configuration of the workflow.")] = Path(
        "config/config.yaml"
    ),
) -> None:
    """Add a model to the workflow: a block in the configuration and a row in the register.

    The geometry is read first, and the block is checked as the workflow will check it. A file
    from outside the repository is copied to data_sources/NAME/. Comments in the configuration
    stay; a name that already exists is rejected.

    For example:

    * `tusqh add part.stl --name bracket --unit mm --betti 1,2,0 --licence CC-BY-4.0`

    * `tusqh add package:pyvista/examples/nut.ply --name nut --cells 32`
    """
    from tusqh.add_model import add_model

    name = name or Path(geometry).stem
    model = Model(geometry=geometry, settings=settings)
    block, row = add_model(config, name, model, licence=licence, origin=origin, url=url)
    console = make_console(markup=False, highlight=False)
    console.print(f"added to {config}:\n\n{block}")
    console.print(f"SHA-256 {row['sha256']}; known defects: {row['known_defects']}")
    console.print(f"make it with: snakemake --cores 2 results/{name}/certificate.json")
