"""Read the files that every page contains: its template, style and scripts, and three.js."""

from __future__ import annotations

from importlib import resources

#: The scripts of the page, in loading order.
SCRIPTS = (
    *("colours", "payload", "plateaus", "faces", "shaders", "layers", "stage", "axes"),
    *("curves", "diagram", "tables", "main"),
)

#: The folder of the page's own files; a change in any of them causes all pages to be rebuilt.
PAGE = "page"
TEMPLATE, STYLE = f"{PAGE}/template.html", f"{PAGE}/explorer.css"
THREE, THREE_LICENCE = "vendor/three.iife.min.js", "vendor/three.LICENSE"


def read_asset(name: str) -> str:
    """Return the text of a file of this package.

    Parameters
    ----------
    name
        Path relative to this package, such as ``page/template.html``.

    Examples
    --------
    >>> read_asset(TEMPLATE).splitlines()[0]
    '<!doctype html>'
    """
    return resources.files("tusqh.explorer").joinpath(name).read_text(encoding="utf-8")


def read_script() -> str:
    """Return the scripts of the page as one."""
    return "\n".join(read_asset(f"{PAGE}/{name}.js") for name in SCRIPTS)


def read_three() -> str:
    """Return three.js with its licence."""
    licence = read_asset(THREE_LICENCE)
    return f"/*! three.js\n{licence}*/\n{read_asset(THREE)}"
