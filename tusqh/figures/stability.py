"""Which topology a model has at every grid size and threshold, and how robust it is."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from tusqh.experiments.orientation import POLICY, RAW, ROBUST
from tusqh.figures import style


def draw_stability(stability: pd.DataFrame, *, threshold: float, name: str) -> Figure:
    """Return a map of the most frequent topology of raw cells, and one of our meshes.

    Parameters
    ----------
    stability
        See `tusqh.experiments.orientation.map_stability`.
    threshold
        The model's chosen threshold, dimensionless; marked.
    name
        The model, for the title.
    """
    cells, thresholds = (np.sort(stability[key].unique()) for key in ("cells", "threshold"))
    has_voids = bool(stability["betti_2"].any())
    figure, axes = style.new_figure(
        1, 2, width=3.2 + 2.0 * len(cells), height=0.36 * len(thresholds) + 2.2
    )
    image = None
    for panel, scheme in zip(axes[0], (RAW, POLICY), strict=True):
        of_scheme = stability[stability["scheme"] == scheme]
        shares = of_scheme.pivot(index="threshold", columns="cells", values="agreement")
        image = panel.imshow(
            shares.to_numpy(), vmin=0, vmax=1, cmap="viridis", origin="lower", aspect="auto"
        )
        for row in of_scheme.itertuples():
            x, y = np.searchsorted(cells, row.cells), np.searchsorted(thresholds, row.threshold)
            numbers = [row.betti_0, row.betti_1] + [row.betti_2] * has_voids
            panel.text(
                x,
                y,
                ", ".join(map(str, numbers)),
                ha="center",
                va="center",
                fontsize=7,
                color="black" if float(str(row.agreement)) > 0.6 else "white",
            )
            if float(str(row.agreement)) >= ROBUST:
                box = Rectangle((x - 0.47, y - 0.45), 0.94, 0.9, fill=False, linewidth=1.4)
                box.set_edgecolor(style.CONNECTING)
                panel.add_patch(box)
        labels = [f"{t:.3g}{' *' if t == threshold else ''}" for t in thresholds]
        panel.set_yticks(np.arange(len(thresholds)), labels)
        panel.set_xticks(np.arange(len(cells)), cells)
        panel.set_xlabel("cells along the longest side [-]")
        panel.set_title({RAW: "kept cells as they are", POLICY: "tusqh"}[scheme])
    axes[0, 0].set_ylabel("volume-fraction threshold [-] (*: chosen)")
    bar = figure.colorbar(image, ax=axes, shrink=0.9)
    bar.set_label("share of placements with the\nmost frequent Betti numbers [-]")
    numbers = r"$\beta_0$, $\beta_1$" + (r", $\beta_2$" if has_voids else "")
    figure.suptitle(f"{name}: most frequent {numbers} over random placements; framed: robust")
    return figure
