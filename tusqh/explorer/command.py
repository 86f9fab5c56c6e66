"""Compose the command line that makes the mesh on the screen."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from tusqh.grid import BackgroundGrid
from tusqh.settings.arguments import to_words
from tusqh.settings.grid import Grid, Window
from tusqh.settings.model import Settings
from tusqh.settings.sampling import Sampling


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


def materials_command(
    stored: Mapping[str, Any], grid: BackgroundGrid, geometry: str, *, name: str
) -> Command:
    """Return the `tusqh mesh` command of a model of several materials.

    Parameters
    ----------
    stored
        Its certificate.
    grid
        The background grid.
    geometry
        The first geometry file, as named in the configuration.
    name
        The model, which names the output file.
    """
    known = stored.get("settings", {})
    settings = Settings(
        grid=Grid(cells=grid.shape, placement="corner"),
        window=Window(lower=grid.origin, upper=grid.upper),
        sampling=Sampling.from_dict(known.get("sampling", {})),
    )
    words = ["tusqh", "mesh", geometry, "--materials", *to_words(settings, without=("goal",))]
    if known.get("rest"):
        words += ["--rest", known["rest"]]
    base = stored.get("base", stored["thresholds"])
    wanted = [f"--material={k}={t:.6g}" for k, t in base.items() if t != 1.0]
    done = [f"--{w['do']}={w['material']}:{w['row']}" for w in stored.get("features", [])]
    note = "names and other files of the materials, and their targets, are not known here"
    return Command(
        shlex.join(words), shlex.join(["-o", f"{name}.vtu"]), shlex.join(wanted + done), note
    )


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
