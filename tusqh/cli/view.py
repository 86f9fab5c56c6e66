"""`tusqh view`: the explorer of a model, in the browser."""

from __future__ import annotations

import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from tusqh.cli import options
from tusqh.cli.progress import shown
from tusqh.cli.show import make_console
from tusqh.settings.arguments import to_words
from tusqh.settings.model import Settings


@options.with_settings(without=("memory",))
def view(
    source: Annotated[
        str,
        typer.Argument(
            metavar="SOURCE",
            help=f"A result folder, or a geometry to mesh: {options.FORMATS}; package:NAME/FILE.",
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            help="The page to write. (default view.html in the folder, or GEOMETRY.html here)",
        ),
    ] = None,
    is_opened: Annotated[
        bool, typer.Option("--open/--no-open", help="Open the page in the browser, or not.")
    ] = True,
    *,
    settings: Settings,
) -> None:
    """Show a model at every threshold, in one page that needs only a browser.

    A result folder is shown unchanged, by the page of the workflow if there is one; a geometry
    is meshed first, as by tusqh mesh, and its options then count. The page holds everything: it
    can be moved, and sent to others.

    For example:

    * `tusqh view results/bearings`

    * `tusqh view part.stl --cells 48 --betti 1,0,0 --no-open -o part.html`
    """
    folder = Path(source)
    if folder.is_dir():
        for word in to_words(settings):
            if word.startswith("--"):
                typer.echo(f"noted: {word} has no effect, since the results exist already")
        page = _from_folder(folder, output)
    else:
        page = output or Path(folder.stem + ".html")
        _write_from_geometry(page, source, settings)
    console = make_console(highlight=False, markup=False, soft_wrap=True)
    console.print(f"{page} ({page.stat().st_size / 1e6:.1f} MB)")
    if is_opened and not webbrowser.open(page.absolute().as_uri()):
        console.print("no browser was found: open that file in one")


def _from_folder(folder: Path, output: Path | None) -> Path:
    """Return the page of a result folder; the workflow's is used if its inputs have not changed."""
    from tusqh.atomic import write_text
    from tusqh.explorer.files_read import FILES_OF_MATERIALS, FILES_READ
    from tusqh.explorer.materials import (
        has_materials,
        make_materials_page,
        read_materials_subject,
    )
    from tusqh.explorer.page import make_page
    from tusqh.explorer.subject import read_subject
    from tusqh.files import path_of

    made, is_several = folder / "explorer.html", has_materials(folder)
    files = [path_of(name, folder) for name in (FILES_OF_MATERIALS if is_several else FILES_READ)]
    if output is None and made.is_file() and all(file.is_file() for file in files):
        newest = max(file.stat().st_mtime for file in files)
        if newest <= made.stat().st_mtime:
            return made
    page = output or folder / "view.html"
    if is_several:
        text = make_materials_page(read_materials_subject(folder))
    else:
        text = make_page(read_subject(folder))
    write_text(page, text)
    return page


def _write_from_geometry(page: Path, source: str, settings: Settings) -> None:
    """Mesh a geometry and write its page."""
    from tusqh.atomic import require_writable, write_text
    from tusqh.explorer.page import make_page
    from tusqh.explorer.subject import subject_of
    from tusqh.pipeline.stages import run_stages

    require_writable(page)
    with shown() as progress:
        result = run_stages(source, settings, progress=progress)
        progress("explorer")
        text = make_page(subject_of(result, geometry=source))
    write_text(page, text)
