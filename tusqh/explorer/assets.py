"""The files that every page holds: its template, style and scripts, and three.js."""

from __future__ import annotations

import hashlib
from importlib import resources

#: The scripts of the page in the order in which they are read.
SCRIPTS = (
    *("colours", "payload", "plateaus", "faces", "shaders", "layers", "stage", "axes"),
    *("curves", "diagram", "tables", "main"),
)

TEMPLATE, STYLE = "page/template.html", "page/explorer.css"
THREE, THREE_LICENCE = "vendor/three.iife.min.js", "vendor/three.LICENSE"


def read_asset(name: str) -> str:
    """Return the text of a file of this package.

    >>> read_asset(TEMPLATE).splitlines()[0]
    '<!doctype html>'
    """
    return resources.files("tusqh.explorer").joinpath(name).read_text(encoding="utf-8")


def read_script() -> str:
    """Return the scripts of the page as one."""
    return "\n".join(read_asset(f"page/{name}.js") for name in SCRIPTS)


def read_three() -> str:
    """Return three.js with its licence."""
    licence = read_asset(THREE_LICENCE)
    return f"/*! three.js\n{licence}*/\n{read_asset(THREE)}"


def assets_fingerprint() -> str:
    """Return the SHA-256 of all of it: pages are made anew when it changes."""
    text = "\0".join([read_asset(TEMPLATE), read_asset(STYLE), read_three(), read_script()])
    return hashlib.sha256(text.encode()).hexdigest()
