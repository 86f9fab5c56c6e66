"""Draw histograms of the scaled Jacobians of a staircase and of the fitted mesh."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from tusqh.figures import style
from tusqh.meshes.volume_mesh import VolumeMesh

#: Ends of the bars.
_EDGES = np.linspace(0, 1, 41)


def draw_jacobians(staircase: VolumeMesh, fitted: VolumeMesh, *, name: str) -> Figure:
    """Return a figure with the numbers of elements over their scaled Jacobian, of two meshes.

    Parameters
    ----------
    staircase, fitted
        The mesh before and after its boundary was moved.
    name
        The model, for the title.
    """
    figure, ((axes,),) = style.new_figure(1, 1, width=6.5, height=3.8)
    kind = "quads" if fitted.dim == 2 else "hexes"
    for title, mesh, look in (
        ("staircase", staircase, {"color": "#404040", "histtype": "step", "linewidth": 1.5}),
        ("fitted", fitted, {"color": style.MATERIAL, "edgecolor": "white", "zorder": 0}),
    ):
        scaled = np.clip(mesh.jacobians.scaled, 0, 1)
        label = f"{title}: {mesh.n_cells:,} {kind}, smallest {scaled.min():.2f}"
        axes.hist(scaled, bins=_EDGES, label=label, **look)
    axes.set_yscale("log")
    axes.set_xlim(0, 1)
    axes.set_ylim(bottom=0.7)
    axes.set_xlabel("scaled Jacobian of the element [-]")
    axes.set_ylabel(f"{kind} [-]")
    axes.set_title(f"{name}: quality of the elements")
    axes.legend(loc="upper left", frameon=False)
    return figure
