"""Find geometry files inside installed packages, where they are read without a copy."""

from __future__ import annotations

from importlib import metadata
from pathlib import Path

from tusqh.errors import GeometryError

#: A geometry with this prefix names a file inside an installed package: ``package:NAME/FILE``.
PACKAGE = "package:"


def locate(geometry: str) -> Path:
    """Return the path of a geometry, which may be inside an installed package.

    Parameters
    ----------
    geometry
        A path, or ``package:NAME/FILE``.

    Raises
    ------
    GeometryError
        The package is not installed or has no such file.
    """
    if not geometry.startswith(PACKAGE):
        return Path(geometry)
    name, _, inner = geometry.removeprefix(PACKAGE).partition("/")
    try:
        files = metadata.files(name) or []
    except metadata.PackageNotFoundError:
        files = []
    for file in files:
        if file.as_posix().endswith(inner):
            return Path(str(file.locate()))
    raise GeometryError(
        f"the package {name!r} has no file {inner!r}",
        where=geometry,
        expected="a file of an installed package, as package:NAME/FILE",
        remedy=f"pip install {name}, or give the path of a file instead",
    )
