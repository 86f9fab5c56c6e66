"""Options of the commands that concern a whole workflow."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

Snakefile = Annotated[Path, typer.Option(help="The workflow.")]
ConfigFiles = Annotated[
    list[Path] | None,
    typer.Option(help="Configuration file that the results were made with, as for snakemake."),
]
LockFile = Annotated[Path, typer.Option(help="The lock.")]
