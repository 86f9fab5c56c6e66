"""Remarks on materials that have no cell in the mesh, and on settings without effect."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tusqh.contacts import MaterialFractions, MaterialMesh
from tusqh.contacts.material_fractions import FULL
from tusqh.contacts.score_field import score_field
from tusqh.geometry.remark import Remark
from tusqh.grid import doubled
from tusqh.pipeline.materials.gather import Gathered
from tusqh.settings.goal import Goal
from tusqh.settings.materials import Material
from tusqh.settings.model import Settings

#: Number of materials that a remark lists.
_MOST = 8


def leave_out(gathered: Gathered, names: Sequence[str]) -> Gathered:
    """Return the materials without some of them, with a remark that names these.

    Parameters
    ----------
    gathered
        The materials.
    names
        Parts without a sample in the window.
    """
    if not names:
        return gathered
    shown = ", ".join(names[:_MOST]) + (", ..." if len(names) > _MOST else "")
    remark = Remark("left out", f"parts without a sample in the window: {shown}", len(names))
    kept = {name: s for name, s in gathered.surfaces.items() if name not in names}
    return replace(gathered, surfaces=kept, remarks=(*gathered.remarks, remark))


def note_absent(
    found: MaterialMesh, fractions: MaterialFractions, thresholds: dict[str, float]
) -> tuple[Remark, ...]:
    """Return a remark for each material without elements, with a threshold that gives it one.

    Parameters
    ----------
    found
        The mesh.
    fractions
        Fractions of all materials.
    thresholds
        Threshold of every material by name.

    Returns
    -------
    remarks
        They count as "left out".
    """
    grid, volumes = fractions.grid, fractions.volumes()
    absent = np.setdiff1d(np.arange(fractions.void), found.material)
    values = np.array([thresholds[name] for name in fractions.names])
    remarks = []
    for k in absent.tolist():
        shares = score_field(fractions, k, values)[doubled.cells(grid.dim)] / FULL
        best = float(shares.max())
        size = min(grid.cell_size, volumes[fractions.names[k]] ** (1 / grid.dim)) / 2
        if best == 0 and volumes[fractions.names[k]] == 0:
            what = f"material whose fractions are 0 everywhere: {fractions.names[k]}"
            remarks.append(Remark("left out", what, 1, "check where it comes from"))
            continue
        fewer = f"a threshold below {best / (1 - best):.3g}, or " if best > 0 else ""
        remarks.append(
            Remark(
                "left out",
                f"material that wins no cell: {fractions.names[k]}",
                1,
                f"{fewer}cells of about {size:.3g} give it some",
            )
        )
    return tuple(remarks)


def note_scope(goal: Goal, wishes: Sequence[Material]) -> tuple[Remark, ...]:
    """Return a remark if a scope is given, but no material has a target.

    Parameters
    ----------
    goal
        The scope and wishes for features.
    wishes
        The materials.

    Returns
    -------
    remarks
        One remark or none; it counts as "noted".
    """
    if goal.scope is None or goal.features or any(m.target is not None for m in wishes):
        return ()
    what = "setting without effect: `scope` applies only where a material has a target"
    return (Remark("noted", what, 1, "remove it"),)


def note_unsupported(settings: Settings) -> tuple[Remark, ...]:
    """Return a remark for each setting that only meshes of one material support.

    Parameters
    ----------
    settings
        The given settings.

    Returns
    -------
    remarks
        They count as "noted".
    """
    given = {
        "fit": settings.fitting.fit,
        "coarsen": settings.coarsening.coarsen is not None,
    }
    return tuple(
        Remark(
            "noted",
            f"setting without effect: `{name}` does not apply to several materials yet",
            1,
            "mesh the materials one by one to use it",
        )
        for name, is_given in given.items()
        if is_given
    )
