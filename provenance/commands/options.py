"""The options of commands that look at a whole workflow."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

Snakefile = Annotated[Path, typer.Option(help="The workflow.")]
ConfigFiles = Annotated[
    list[Path] | None,
    typer.Option(help="As for snakemake, when the results were made with one."),
]
LockFile = Annotated[Path, typer.Option(help="The lock to compare with.")]
