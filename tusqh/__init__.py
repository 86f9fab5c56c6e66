"""Make quad and hex meshes with a chosen topology from unrepaired geometry.

`tusqh.mesh` makes a mesh in one call.  Importing the package imports nothing else: a public name
is imported when it is first used.  `docs/public.md` lists the stable names.
"""

from importlib import import_module
from typing import Any

#: The version is defined only here; `pyproject.toml` reads it.
__version__ = "0.1.0"

#: The module of each public name; `__init__.pyi` states the same for type checkers.
_MODULES = {
    "Image": "tusqh.geometry.image",
    "MaterialsResult": "tusqh.pipeline.materials.result",
    "Outline": "tusqh.geometry.outline",
    "Result": "tusqh.pipeline.result",
    "Soup": "tusqh.geometry.soup",
    "TusqhError": "tusqh.errors",
    "VolumeMesh": "tusqh.meshes.volume_mesh",
    "mesh": "tusqh.pipeline.mesh",
}

__all__ = [
    "Image",
    "MaterialsResult",
    "Outline",
    "Result",
    "Soup",
    "TusqhError",
    "VolumeMesh",
    "__version__",
    "mesh",
]


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_MODULES[name]), name)


def __dir__() -> list[str]:
    """Return the public names."""
    return __all__
