"""Read the files that every page contains: its template, style and scripts, and three.js."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import resources

#: The scripts of the page, in loading order.
SCRIPTS = (
    *("colours", "payload", "plateaus", "faces", "shaders", "layers", "stage", "axes"),
    *("curves", "diagram", "changes", "tables", "common", "main"),
)

#: Those of the page about several materials, which has no threshold to move.
SCRIPTS_OF_MATERIALS = (
    *("colours", "payload", "faces", "shaders", "layers", "stage", "axes"),
    *("changes", "tables", "common", "features", "materials"),
)

#: The folder of the page's own files; a change in any of them causes all pages to be rebuilt.
PAGE = "page"
FRAME, TEMPLATE, STYLE = f"{PAGE}/frame.html", f"{PAGE}/template.html", f"{PAGE}/explorer.css"
TEMPLATE_OF_MATERIALS = f"{PAGE}/materials.html"
THREE, THREE_LICENCE = "vendor/three.iife.min.js", "vendor/three.LICENSE"


def read_asset(name: str) -> str:
    """Return the text of a file of this package.

    Parameters
    ----------
    name
        Path relative to this package, such as ``page/frame.html``.

    Examples
    --------
    >>> read_asset(FRAME).splitlines()[0]
    '<!doctype html>'
    """
    return resources.files("tusqh.explorer").joinpath(name).read_text(encoding="utf-8")


def read_script(names: Sequence[str] = SCRIPTS) -> str:
    """Return the scripts of a page as one.

    Parameters
    ----------
    names
        The scripts, in loading order.
    """
    return "\n".join(read_asset(f"{PAGE}/{name}.js") for name in names)


def read_three() -> str:
    """Return three.js with its licence."""
    licence = read_asset(THREE_LICENCE)
    return f"/*! three.js\n{licence}*/\n{read_asset(THREE)}"
