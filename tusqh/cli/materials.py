"""What `tusqh mesh --materials` prints and writes."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from tusqh.cli.outputs import Outputs
from tusqh.cli.show import report_error, show
from tusqh.errors import ConfigError, TopologyError
from tusqh.settings.goal import Target
from tusqh.settings.materials import Material
from tusqh.settings.model import Settings

if TYPE_CHECKING:
    from tusqh.pipeline.materials.result import MaterialsResult


#: Largest number of groups of changed cells that are printed.
_MOST_CHANGES = 8


@dataclass(frozen=True)
class Shown:
    """What a command prints, and how it ends.

    Parameters
    ----------
    as_json
        Print JSON instead of tables.
    is_strict
        End with exit code 3 where there are warnings.
    """

    as_json: bool
    is_strict: bool = False


def mesh_and_show(
    sources: Sequence[str],
    wishes: Sequence[str],
    settings: Settings,
    *,
    rest: str | None,
    files: Outputs,
    shown: Shown,
) -> None:
    """Mesh several materials, write the mesh and print a row for each of them.

    Parameters
    ----------
    sources
        A file for each material, or one file of parts or labels.
    wishes
        Wishes for materials, see `read_wish`.
    settings
        The settings of the command line.
    rest
        Name of the material that fills what the others leave; None: that is void.
    files
        What to write.
    shown
        What to print.

    Raises
    ------
    typer.Exit
        With code 1 if a wish cannot be fulfilled or a check fails, 3 if there are warnings and
        `is_strict`, otherwise 0.
    """
    from tusqh.pipeline.materials.mesh import mesh_several

    source = sources[0] if len(sources) == 1 else list(sources)
    materials = [read_wish(text) for text in wishes]
    try:
        found = mesh_several(source, settings, materials=materials, rest=rest)
    except TopologyError as error:
        report_error(str(error))
        raise typer.Exit(1) from None
    paths = files.write(found)
    if shown.as_json:
        typer.echo(json.dumps(found.to_dict(), indent=2))
    else:
        _show(found, paths)
    if not found.is_as_predicted:
        raise typer.Exit(1)
    raise typer.Exit(3 if shown.is_strict and found.has_warnings else 0)


def read_wish(text: str) -> Material:
    """Return the wish for a material that the option ``--material`` describes.

    Parameters
    ----------
    text
        The name of the material, an equals sign, and a threshold, Betti numbers as for ``--betti``,
        or ``label N``, the label that has this name.

    Raises
    ------
    ConfigError
        The text is none of these.

    Examples
    --------
    >>> read_wish("ring=0.4").threshold, str(read_wish("ball=1,0,*").target)
    (0.4, 'betti_0 = 1, betti_1 = 0')
    >>> read_wish("bone=label 2").label
    2
    """
    name, _, value = text.partition("=")
    try:
        if value.startswith("label "):
            return Material.from_dict({"name": name, "label": int(value.removeprefix("label "))})
        if "," in value:
            return Material.from_dict({"name": name, "target": Target.from_option(value)})
        return Material.from_dict({"name": name, "threshold": float(value)})
    except ValueError:
        raise ConfigError(
            f"found {text!r}",
            where="option --material",
            expected="NAME=THRESHOLD, NAME=BETTI,NUMBERS or NAME=label NUMBER",
            remedy="give for instance --material ring=0.4 or --material ball=1,0,0",
        ) from None


def _show(found: MaterialsResult, outputs: Sequence[Path]) -> None:
    """Print a row for every material and for every pair that meets, overlaps or has a gap."""
    table = found.materials
    rows = table[["material", "elements", "volume"]].copy()
    for how in ("predicted", "measured"):
        betti = table[[f"betti_{k}_{how}" for k in range(3)]].to_numpy().tolist()
        rows[how] = [str(tuple(row)) for row in betti]
    rows["holds"] = table["holds"].map({True: "yes", False: "no"})
    show(rows, title=f"Materials of {found.mesh.name}")
    if len(found.pairs):
        show(found.pairs, title="Pairs")
    for row in found.changes.head(_MOST_CHANGES).to_dict("records"):
        wish = f", {row['do']} {row['class']} row {row['row']} of {row['material']}"
        what = f"{row['cells']:,} cells from {row['from']} to {row['to']}"
        typer.echo(f"changed  {what}{wish if row['do'] else ''}")
    if len(found.changes) > _MOST_CHANGES:
        typer.echo(f"changed  {len(found.changes) - _MOST_CHANGES} more groups, see changes.csv")
    for remark in found.remarks:
        typer.echo(str(remark))
    warned = found.verdict[found.verdict["holds"] == "warning"]
    for check in warned.itertuples():
        typer.echo(f"warning: {check.name}: {check.found}, required {check.required}")
    typer.echo(f"contacts {found.built.n_contacts}, votes overruled {found.built.n_overruled}")
    typer.echo("written  " + ", ".join(map(str, outputs)))
