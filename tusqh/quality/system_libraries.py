"""Find missing system libraries that Python wheels need but cannot contain."""

from __future__ import annotations

import ctypes
import os
import sys

from tusqh.errors import TusqhError

#: The purposes that libraries serve.
SURFACE_CHECKS, RENDERING = "pymeshlab's checks of the mesh surface", "pictures of solids"

#: Alternative libraries, the Debian package of the first one, and the purpose.
REQUIRED = (
    (("libGL.so.1",), "libgl1", SURFACE_CHECKS),
    (("libX11.so.6",), "libx11-6", SURFACE_CHECKS),
    (("libEGL.so.1", "libOSMesa.so.8"), "libegl1", RENDERING),
)


class SystemLibraryError(TusqhError):
    """A system library that a Python package needs is missing."""


def find_missing_libraries() -> list[tuple[str, str, str]]:
    """Return library, Debian package and purpose of missing libraries; always empty off Linux.

    Returns
    -------
    list of tuple
        One row for each row of `REQUIRED` without a library that can be loaded.
    """
    return [
        (names[0], package, purpose)
        for names, package, purpose in REQUIRED
        if sys.platform == "linux" and not any(map(_can_load, names))
    ]


def describe_missing() -> str:
    """Return a line for users about missing libraries.

    Returns
    -------
    str
        Names, Debian packages and the affected purposes; empty if nothing is missing.
    """
    missing = find_missing_libraries()
    if not missing:
        return ""
    names = ", ".join(name for name, _, _ in missing)
    packages = " ".join(package for _, package, _ in missing)
    purposes = " and ".join(sorted({purpose for _, _, purpose in missing}))
    return (
        f"{names} not found, needed for {purposes}: "
        f"install {packages} (Debian, Ubuntu: apt-get install {packages})"
    )


def check_rendering() -> None:
    """Check that pictures of solids can be rendered, because VTK would exit without a message.

    Raises
    ------
    SystemLibraryError
        Neither EGL nor OSMesa can be loaded, and there is no display.
    """
    names = [
        name for name, _, purpose in find_missing_libraries() if purpose == "pictures of solids"
    ]
    if names and not os.environ.get("DISPLAY"):
        raise SystemLibraryError(
            f"{names[0]} cannot be loaded",
            where="rendering a picture of a solid",
            expected="EGL or OSMesa, which VTK renders with",
            remedy=describe_missing(),
        )


def _can_load(name: str) -> bool:
    try:
        ctypes.CDLL(name)
    except OSError:
        return False
    return True
