"""Run all stages for several materials in one call."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from tusqh.contacts import MaterialFractions
from tusqh.errors import ConfigError
from tusqh.geometry.remark import Remark
from tusqh.pipeline.materials.gather import Gathered, gather, is_pair, require_known
from tusqh.pipeline.materials.original import MaterialsOriginal
from tusqh.pipeline.materials.remarks import leave_out, note_absent, note_scope, note_unsupported
from tusqh.pipeline.materials.result import MaterialsResult
from tusqh.pipeline.materials.sample import Sampled
from tusqh.pipeline.materials.wishes import fulfil
from tusqh.settings.materials import Materials, to_materials
from tusqh.settings.model import Settings


def has_several_materials(source: Any, materials: Materials | None) -> bool:
    """Return whether a call is for several materials: they are given, or the source is a list.

    Parameters
    ----------
    source, materials
        Arguments of `tusqh.mesh`.

    Examples
    --------
    >>> has_several_materials(["a.stl", "b.stl"], None), has_several_materials("a.stl", None)
    (True, False)
    """
    if materials is not None or isinstance(source, MaterialFractions):
        return True
    return isinstance(source, (list, tuple, dict)) and not is_pair(source)


def mesh_several(
    source: Any,
    settings: Settings,
    *,
    materials: Materials = "parts",
    rest: str | None = None,
    name: str | None = None,
) -> MaterialsResult:
    """Return the mesh of several materials, each with the topology wished for.

    Parameters
    ----------
    source
        Files, parts or labels, see `tusqh.pipeline.materials.gather.gather`; or the fractions of
        all materials.
    settings
        Only the grid, the window, the samples, the size of voxels, the quality, the scope and
        features, which name their material, have an effect.
    materials
        Names and wishes, see `tusqh.settings.materials.to_materials`.
    rest
        Name of the material that fills what the others leave of the grid or window; None: that is
        void.
    name
        Name of the model in files and messages; None: the name of the file.

    Raises
    ------
    ConfigError
        A given setting has no effect here, or a material does not exist.
    GeometryError
        A file cannot be read, or holds no labels.
    SamplingError
        A material has no sample, or lies wholly inside an earlier one.
    TopologyError
        A wish cannot be fulfilled; the message says which, and what can be reached.

    Examples
    --------
    >>> import numpy as np
    >>> labels = np.array([[1, 1, 0], [1, 2, 2], [0, 2, 2]])
    >>> found = mesh_several(labels, Settings(), materials={1: "shell", 2: "core"})
    >>> found.materials[["material", "elements", "volume", "holds"]].values.tolist()
    [['shell', 3, 3.0, True], ['core', 4, 4.0, True], ['all', 7, 7.0, True]]
    """
    _require_no_others(settings)
    if name is None:
        name = Path(source).stem if isinstance(source, (str, Path)) else "model"
    wishes = to_materials(materials)
    if isinstance(source, MaterialFractions):
        gathered, sampled, original = Gathered(wishes), Sampled(source), None
        require_known(wishes, source.names)
    else:
        gathered = gather(source, wishes, settings.image, settings.lengths)
        if gathered.image is not None and settings.window is not None:
            raise _without_effect("window", "leave it out: labels are meshed as a whole")
        original = MaterialsOriginal(
            gathered, settings.grid, settings.sampling, settings.window, rest
        )
        sampled = original.sample()
        gathered = leave_out(gathered, sampled.left_out)
        original = replace(original, gathered=gathered)
    goal = settings.goal
    found = fulfil(
        sampled.fractions,
        gathered.wishes,
        features=goal.features or (),
        is_local=goal.scope != "global",
        name=name,
    )
    absent = note_absent(found.mesh, sampled.fractions, found.thresholds)
    remarks = gathered.remarks + absent + note_unsupported(settings)
    remarks += note_scope(goal, gathered.wishes)
    if sampled.placement is not None:
        remarks += (Remark("noted", f"grid, {sampled.placement}", 1),)
    return MaterialsResult(
        found.mesh,
        sampled.fractions,
        found.thresholds,
        sampled.overlaps,
        remarks,
        settings.quality.volume_tolerance,
        settings.quality.checks,
        original,
        base=found.base,
        local=found.local,
    )


def _require_no_others(settings: Settings) -> None:
    """Raise a `ConfigError` if a given setting does not apply to several materials."""
    default = Settings()
    usual = default.goal.to_dict(defaults=False)
    wished = settings.goal.to_dict(defaults=False) | settings.policy.to_dict(defaults=False)
    applies = ("scope", "features")
    given = [n for n, value in wished.items() if usual.get(n) != value and n not in applies]
    for section, names in (
        ("sampling", ("domain", "rule")),
        ("image", ("empty", "full", "labels")),
    ):
        mine, other = getattr(settings, section), getattr(default, section)
        given += [n for n in names if getattr(mine, n) != getattr(other, n)]
    if given:
        raise _without_effect(
            ", ".join(given), "leave them out; thresholds and targets belong to each material"
        )


def _without_effect(what: str, remedy: str) -> ConfigError:
    """Return the error for settings that do not apply to several materials."""
    return ConfigError(
        f"{what} together with several materials",
        where="materials",
        expected="settings of the grid, the window, the samples, the voxels, the checks, the "
        "scope and features only",
        remedy=remedy,
    )
