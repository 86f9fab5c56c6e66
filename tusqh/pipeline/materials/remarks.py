"""Remarks on materials that have no cell in the mesh, and on settings without effect."""

from __future__ import annotations

import numpy as np

from tusqh.contacts import MaterialFractions, MaterialMesh
from tusqh.contacts.material_fractions import FULL
from tusqh.contacts.score_field import score_field
from tusqh.geometry.remark import Remark
from tusqh.grid import doubled
from tusqh.settings.model import Settings


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


def note_fit(settings: Settings) -> tuple[Remark, ...]:
    """Return a remark if the boundary should be fitted, which only one material allows.

    Parameters
    ----------
    settings
        The given settings.

    Returns
    -------
    remarks
        One remark or none; it counts as "noted".
    """
    if not settings.fitting.fit:
        return ()
    what = "setting without effect: `fit` does not apply to several materials yet"
    return (Remark("noted", what, 1, "mesh the materials one by one to fit them"),)
