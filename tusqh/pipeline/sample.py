"""Stage 2: the background grid over a geometry, and its volume fractions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tusqh.geometry.image import Image
from tusqh.geometry.kinds import Geometry
from tusqh.progress import Progress, log_progress
from tusqh.sampling.fractions import VolumeFractions, require_memory, sample_fractions
from tusqh.sampling.layout import lay_grid, to_window
from tusqh.sampling.voxels import lay_on_voxels, voxel_fractions


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
        ``{"cell_size": h}`` in units of the geometry.  Cells of images are whole voxels, see
        `tusqh.sampling.voxels.lay_on_voxels`.
    window
        Box to mesh in, ``{"lower": [...], "upper": [...]}``; the bounding box by default.
    progress
        Shows how far the samples are.
    **sampling
        `samples`, `domain`, `rule`, `orientation`, `sampler` and `tolerance`, see
        `tusqh.sampling.fractions.sample_fractions`; images, whose fractions are exact, need
        only `domain`.

    Raises
    ------
    SamplingError
        Grid, window and geometry do not fit each other, or there is nothing inside.
    """
    box = to_window(window)
    if isinstance(geometry, Image):
        voxel_grid = lay_on_voxels(geometry, box, **grid)
        domain = sampling.get("domain", "inside")
        return voxel_fractions(geometry, voxel_grid, domain=domain, window=box)
    background_grid = lay_grid(geometry, box, **grid)
    require_memory(background_grid, "meshing", name=geometry.name)
    return sample_fractions(
        geometry, background_grid, window=box, progress=progress("samples"), **sampling
    )
