"""Volume-fraction quad and hex meshes with a chosen topology, from geometry nobody repaired.

`tusqh.mesh` makes a mesh in one call.  Importing the package imports nothing else: names are
found when they are used.
"""

from importlib import import_module
from typing import Any

__version__ = "0.1.0"

__all__ = ["Result", "TusqhError", "__version__", "mesh"]

#: Where the public names are; `__init__.pyi` has them for type checkers.
_MODULES = {
    "Result": "tusqh.pipeline.result",
    "TusqhError": "tusqh.errors",
    "mesh": "tusqh.pipeline.mesh",
}


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_MODULES[name]), name)


def __dir__() -> list[str]:
    """Return the public names."""
    return __all__
