"""Stage 2: lay the background grid over a geometry, and sample its volume fractions."""

from __future__ import annotations

from dataclasses import replace

from tusqh.geometry.image import Image
from tusqh.geometry.kinds import Geometry
from tusqh.progress import Progress, log_progress
from tusqh.sampling.fractions import VolumeFractions, sample_fractions
from tusqh.sampling.inside import field_of
from tusqh.sampling.layout import lay_as_set
from tusqh.sampling.memory import require_memory
from tusqh.sampling.orient import orient
from tusqh.sampling.place import place_grid
from tusqh.sampling.placement import Placement
from tusqh.sampling.reference import Reference, find_reference, signed_volume
from tusqh.sampling.voxels import lay_on_voxels, voxel_fractions
from tusqh.settings.grid import Grid, Window
from tusqh.settings.sampling import Sampling

#: The threshold for which a grid is placed if the goal does not give one.
BASE_THRESHOLD = 0.5


def sample(
    geometry: Geometry,
    *,
    grid: Grid,
    sampling: Sampling | None = None,
    window: Window | None = None,
    threshold: float | None = None,
    progress: Progress = log_progress,
) -> VolumeFractions:
    """Return the volume fractions of a geometry on the grid that its settings specify.

    Parameters
    ----------
    geometry
        The geometry.
    grid
        The settings of the grid.  Cells of images are whole voxels, see
        `tusqh.sampling.voxels.lay_on_voxels`.
    sampling
        How the fractions are sampled; None: with the defaults.  For images, whose fractions are
        exact, only `domain` matters.
    window
        Box to mesh in; None: the bounding box.
    threshold
        The threshold for which the grid is placed; None: 1/2.
    progress
        Shows how many samples have been taken.

    Raises
    ------
    SamplingError
        Grid, window and geometry do not match, or nothing is inside.
    """
    return sample_with_reference(
        geometry,
        grid=grid,
        sampling=sampling,
        window=window,
        threshold=threshold,
        progress=progress,
    )[0]


def sample_with_reference(
    geometry: Geometry,
    *,
    grid: Grid,
    sampling: Sampling | None = None,
    window: Window | None = None,
    threshold: float | None = None,
    progress: Progress = log_progress,
) -> tuple[VolumeFractions, Reference | None]:
    """Return the volume fractions of a geometry, and its volume on that grid if it was needed.

    Parameters
    ----------
    geometry, grid, sampling, window, threshold, progress
        See `sample`.

    Returns
    -------
    fractions
        The volume fractions.
    reference
        The volume that the mesh should have; None if it was not needed to place the grid.
    """
    sampling = sampling or Sampling()
    box = None if window is None else window.box
    is_auto = grid.placement == "auto"
    if isinstance(geometry, Image):
        voxel_grid = lay_on_voxels(geometry, box, cells=grid.cells, cell_size=grid.cell_size)
        fractions = voxel_fractions(geometry, voxel_grid, domain=sampling.domain, window=box)
        stays = Placement((0, 0, 0), fractions.samples, reason="its cells are whole voxels")
        return replace(fractions, placement=stays if is_auto else None), None
    laid = lay_as_set([geometry], box, grid, sampling)
    oriented = orient(laid.surfaces[0], sampling.orientation).geometry
    background_grid = laid.grid
    of_geometry = signed_volume(oriented) if sampling.domain == "inside" else None
    made = None
    if sampling.inside != "winding":  # One envelope is enough for all that follows.
        made, of_geometry = field_of(oriented, sampling, background_grid.cell_size), None
    require_memory(background_grid, "meshing", name=geometry.name, volume=of_geometry)
    fractions = sample_fractions(
        oriented,
        background_grid,
        sampling=sampling,
        window=laid.window,
        field=made,
        progress=progress("samples"),
    )
    if laid.placement or not is_auto:
        return replace(fractions, placement=laid.placement), None
    progress("placement")
    reference = find_reference(geometry, fractions, sampling=sampling, window=box)
    placed, placement = place_grid(
        oriented,
        fractions,
        reference.volume,
        sampling=sampling,
        window=laid.window,
        threshold=threshold or BASE_THRESHOLD,
        field=made,
        box=laid.covered,
    )
    if placement.is_moved:
        fractions = sample_fractions(
            oriented,
            placed,
            sampling=sampling,
            window=laid.window,
            field=made,
            progress=progress("samples"),
        )
    of_grid = None if placement.is_moved else reference
    return replace(fractions, placement=placement), of_grid
