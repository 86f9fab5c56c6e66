"""Draw the topology of a model at each grid size and threshold, and its robustness."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from studies.orientation import AS_CONFIGURED, SUB_CELLS, TOUCHING
from studies.stability import ROBUST
from tusqh.figures import style


def draw_stability(stability: pd.DataFrame, *, threshold: float, name: str) -> Figure:
    """Return a figure with maps of the most frequent topology of raw cells and of our meshes.

    There are two maps of our meshes: the first removes no small features, the second follows the
    configuration.

    Parameters
    ----------
    stability
        See `studies.stability.map_stability`.
    threshold
        The model's chosen threshold, dimensionless, which is marked.
    name
        The model, for the title.
    """
    cells, thresholds = (np.sort(stability[key].unique()) for key in ("cells", "threshold"))
    has_voids = bool(stability["betti_2"].any())
    figure, axes = style.new_figure(
        1, 3, width=3.2 + 3.0 * len(cells), height=0.4 * len(thresholds) + 2.0
    )
    image: Any = None
    for panel, scheme in zip(axes[0], (TOUCHING, SUB_CELLS, AS_CONFIGURED), strict=True):
        of_scheme = stability[stability["scheme"] == scheme]
        image = panel.imshow(
            of_scheme.pivot(index="threshold", columns="cells", values="agreement").to_numpy(),
            vmin=0,
            vmax=1,
            cmap="viridis",
            origin="lower",
            aspect="auto",
        )
        column = np.searchsorted(cells, of_scheme["cells"].to_numpy())
        level = np.searchsorted(thresholds, of_scheme["threshold"].to_numpy())
        numbers = of_scheme[["betti_0", "betti_1", "betti_2"]].to_numpy()[:, : 2 + has_voids]
        shares = of_scheme["agreement"].to_numpy()
        for x, y, betti, share in zip(column, level, numbers, shares, strict=True):
            panel.text(
                x,
                y,
                ", ".join(map(str, betti)),
                ha="center",
                va="center",
                fontsize=7,
                color="black" if share > 0.6 else "white",
            )
            if share >= ROBUST:
                box = Rectangle((x - 0.47, y - 0.45), 0.94, 0.9, fill=False, linewidth=1.4)
                box.set_edgecolor(style.CONNECTING)
                panel.add_patch(box)
        labels = [f"{t:.3g}{' *' if t == threshold else ''}" for t in thresholds]
        panel.set_yticks(np.arange(len(thresholds)), labels)
        panel.set_xticks(np.arange(len(cells)), cells)
        panel.set_xlabel("cells along the longest side [-]")
        panel.set_title(scheme)
    axes[0, 0].set_ylabel("volume-fraction threshold [-] (*: chosen)")
    bar = figure.colorbar(image, ax=axes, shrink=0.9)
    bar.set_label("share of placements with the\nmost frequent Betti numbers [-]")
    names = r"$\beta_0$, $\beta_1$" + (r", $\beta_2$" if has_voids else "")
    figure.suptitle(f"{name}: most frequent {names} over random placements; framed: robust")
    return figure
