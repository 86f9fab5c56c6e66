"""Compose the command line that makes the mesh on the screen."""

from __future__ import annotations

import shlex
from dataclasses import dataclass

from tusqh.settings.arguments import to_words
from tusqh.settings.grid import Grid
from tusqh.settings.model import Settings


@dataclass(frozen=True)
class Command:
    """A command to which a threshold or, for the final mesh, its goal is added.

    Parameters
    ----------
    before, after
        The words before and after ``--threshold T``, quoted for a shell.
    goal
        The words that make the final mesh instead; empty if they are those of its threshold.
    note
        What the command omits, in words; often empty.
    """

    before: str
    after: str
    goal: str = ""
    note: str = ""


def mesh_command(geometry: str, settings: Settings, *, name: str) -> Command:
    """Return the `tusqh mesh` command of a model.

    Parameters
    ----------
    geometry
        The geometry file, as named in the configuration.
    settings
        How it is meshed; the goal is kept apart.
    name
        The model, which names the output file.

    Examples
    --------
    >>> settings = Settings.from_dict({"grid": {"cells": 48}, "rule": "clamped"})
    >>> command = mesh_command("my part.stl", settings, name="p")
    >>> print(command.before, command.after)
    tusqh mesh 'my part.stl' --cells 48 --rule clamped -o p.vtu
    """
    words = ["tusqh", "mesh", geometry]
    if settings.grid == Grid():
        words += ["--cells", str(settings.grid.cells)]
    words += to_words(settings, without=("goal",))
    has_changes = settings.goal.is_local or settings.goal.features
    goal = to_words(Settings(goal=settings.goal)) if has_changes else []
    return Command(shlex.join(words), shlex.join(["-o", f"{name}.vtu"]), shlex.join(goal))
