"""`tusqh trace`: the origin of a file."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape
from rich.tree import Tree

from tusqh.cli.show import make_console

if TYPE_CHECKING:
    from provenance.trace import Origin

_WIDTH = 90


def trace(
    path: Annotated[
        Path, typer.Argument(help="A result, a copy of one, or a figure found elsewhere.")
    ],
) -> None:
    """Show the steps and sources behind a file, down to the data with their licences.

    A figure found elsewhere is identified by its bytes, or by the mark in its metadata.

    Exit code 0: identified and unchanged; 1: the file or something behind it has changed;
    2: not identified.
    Example: tusqh trace results/chesapeake/figures/diagram.png
    """
    from provenance.code import PACKAGE_ROOT
    from provenance.digests import Digests
    from provenance.register import read_register
    from provenance.stored import read_records
    from provenance.trace import find_output
    from provenance.trace import trace as trace_file
    from tusqh.geometry.packaged import PACKAGE

    records, digests = read_records(), Digests()
    name = str(path)
    if not name.startswith(PACKAGE) and path.is_absolute() and path.is_relative_to(Path.cwd()):
        path = path.relative_to(Path.cwd())
    match = find_output(path, records, digests)
    origin = trace_file(match.path, records, read_register(Path(), PACKAGE_ROOT), digests)
    console = make_console()
    console.print(
        f"{name} is {match.path}: {match.how}", markup=False, highlight=False, soft_wrap=True
    )
    shown: set[str] = set()
    tree = Tree(_label(origin))
    _grow(tree, origin, shown)
    console.print(tree)
    changed = _changed(origin) | (set() if match.is_same else {name})
    for file in sorted(changed):
        console.print(
            f"changed: {file}", style="red", markup=False, highlight=False, soft_wrap=True
        )
    raise typer.Exit(1 if changed else 0)


def _grow(tree: Tree, origin: Origin, shown: set[str]) -> None:
    for source in origin.inputs:
        if source.path in shown and source.inputs:
            tree.add(f"{escape(source.path)} [dim](above)[/]")
            continue
        shown.add(source.path)
        _grow(tree.add(_label(source)), source, shown)


def _label(origin: Origin) -> str:
    from provenance.trace import lacks_record

    state = "" if origin.is_same else " [red]changed[/]"
    lines = [f"[bold]{escape(origin.path)}[/] [dim]SHA-256 {origin.sha256[:12]}[/]{state}"]
    if origin.step:
        lines.append(f"step {escape(origin.step)}, {escape(origin.code['script'])}")
        for name, value in sorted(origin.parameters.items()):
            text = json.dumps(value)
            text = text if len(text) <= _WIDTH else text[: _WIDTH - 3] + "..."
            lines.append(f"[dim]{name}: {escape(text)}[/]")
    elif origin.source:
        lines.append(escape(f"origin: {origin.source['origin']}"))
        lines.append(escape(f"licence: {origin.source['licence']}"))
        if origin.source["url"]:
            lines.append(escape(origin.source["url"]))
    elif lacks_record(origin.path):
        lines.append("its record is missing; tusqh verify prints the command that makes it again")
    else:
        lines.append("not in data_sources/register.csv: origin and licence are unknown")
    return "\n".join(lines)


def _changed(origin: Origin) -> set[str]:
    own = set() if origin.is_same else {origin.path}
    return own.union(*(_changed(source) for source in origin.inputs))
