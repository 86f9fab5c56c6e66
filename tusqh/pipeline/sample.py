"""Stage 2: the background grid over a geometry, and its volume fractions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tusqh.progress import Progress, log_progress
from tusqh.sampling.fractions import Geometry, VolumeFractions, sample_fractions
from tusqh.sampling.layout import lay_grid, to_window


def sample(
    geometry: Geometry,
    *,
    grid: Mapping[str, Any],
    window: dict[str, list[float]] | None = None,
    progress: Progress = log_progress,
    **sampling: Any,
) -> VolumeFractions:
    """Return the volume fractions of a geometry on the grid that its settings ask for.

    Parameters
    ----------
    geometry
        The geometry.
    grid
        ``{"cells": n}`` along the longest side, ``{"cells": [nx, ny]}``, or
        ``{"cell_size": h}`` in units of the geometry.
    window
        Box to mesh in, ``{"lower": [...], "upper": [...]}``; the bounding box by default.
    progress
        Shows how far the samples are.
    **sampling
        `samples`, `domain`, `rule` and `orientation`, see
        `tusqh.sampling.fractions.sample_fractions`.

    Raises
    ------
    SamplingError
        Grid, window and geometry do not fit each other, or there is nothing inside.
    """
    box = to_window(window)
    background_grid = lay_grid(geometry, box, **grid)
    return sample_fractions(
        geometry, background_grid, window=box, progress=progress("samples"), **sampling
    )
