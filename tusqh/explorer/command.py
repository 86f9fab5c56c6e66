"""The command line that makes the mesh on the screen."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

#: Keys of a model's block that the command has an option for, with their defaults.
_OPTIONS = {
    "samples": 4,
    "domain": "inside",
    "rule": "average",
    "orientation": "auto",
    "mixed_pinches": "separate",
    "bridges": "forest",
}

#: Keys that shape the mesh, whose criteria only the configuration and Python can say.
_CRITERIA = ("components", "holes", "voids")


@dataclass(frozen=True)
class Command:
    """A command to which a threshold is added.

    Parameters
    ----------
    before, after
        Its words before and after ``--threshold T``, quoted for a shell.
    note
        What it does not say, for people; often empty.
    """

    before: str
    after: str
    note: str = ""


def mesh_command(geometry: str, settings: Mapping[str, Any], *, name: str) -> Command:
    """Return the `tusqh mesh` command of a model.

    Parameters
    ----------
    geometry
        Its geometry file, as the configuration names it.
    settings
        Its block of the configuration; keys left out have their defaults.
    name
        The model, for the file to write.

    Examples
    --------
    >>> command = mesh_command("my part.stl", {"grid": {"cells": 48}, "rule": "clamped"}, name="p")
    >>> print(command.before, command.after)
    tusqh mesh 'my part.stl' --cells 48 --rule clamped -o p.vtu
    >>> mesh_command("bay.svg", {"holes": {"min_cells": 4}}, name="bay").note
    'the criteria for holes of this model are in config.yaml'
    """
    words = ["tusqh", "mesh", geometry]
    grid = settings.get("grid", {"cells": 64})
    if "cell_size" in grid:
        words += ["--cell-size", _number(grid["cell_size"])]
    else:
        cells = grid["cells"]
        words += ["--cells", ",".join(map(str, cells)) if isinstance(cells, list) else str(cells)]
    for key, default in _OPTIONS.items():
        if settings.get(key, default) != default:
            words += [f"--{key.replace('_', '-')}", str(settings[key])]
    if "window" in settings:
        corners = [*settings["window"]["lower"], *settings["window"]["upper"]]
        words.append(f"--window={','.join(map(_number, corners))}")  # May begin with a minus.
    components = dict(settings.get("components", {}))
    if "min_cells" in components:
        words += ["--min-cells", str(components.pop("min_cells"))]
    for key, value in settings.get("image", {}).items():
        words += [f"--{key.replace('_', '-')}", _number(value)]
    unsaid = [key for key in _CRITERIA if (dict(settings) | {"components": components}).get(key)]
    note = f"the criteria for {', '.join(unsaid)} of this model are in config.yaml"
    return Command(shlex.join(words), shlex.join(["-o", f"{name}.vtu"]), note if unsaid else "")


def _number(value: float) -> str:
    return repr(value).removesuffix(".0")
