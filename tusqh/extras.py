"""Import optional libraries; the error for a missing one names the extra to install."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

from tusqh.errors import TusqhError

__all__ = ["MissingExtraError", "require"]


class MissingExtraError(TusqhError):
    """A library that only some features need is not installed."""


def require(module: str, *, extra: str) -> ModuleType:
    """Import a library that belongs to an extra.

    Parameters
    ----------
    module
        The name to import, such as ``"ezdxf"`` or ``"mfem.ser"``.
    extra
        The extra of the distribution that installs it, such as ``"formats"``.

    Returns
    -------
    ModuleType
        The imported module.

    Raises
    ------
    MissingExtraError
        The library is not installed.  A library that is installed but fails to load raises its
        own `ImportError`.

    Examples
    --------
    >>> require("json", extra="formats").loads("[1]")
    [1]
    >>> require("no_such_library", extra="formats")
    Traceback (most recent call last):
        ...
    tusqh.extras.MissingExtraError: no_such_library: this Python library is not installed
      expected: the extra "formats" of tusqh
      remedy:   pip install "tusqh[formats]"
    """
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        library = module.partition(".")[0]
        if (error.name or "").partition(".")[0] != library:
            raise
        raise MissingExtraError(
            "this Python library is not installed",
            where=library,
            expected=f'the extra "{extra}" of tusqh',
            remedy=f'pip install "tusqh[{extra}]"',
        ) from None
