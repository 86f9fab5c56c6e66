"""Lay and place the grid of a surface, and sample its fractions in slabs."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from typing import cast

import numpy as np

from tusqh import __version__
from tusqh.atomic import write_text
from tusqh.errors import SamplingError
from tusqh.geometry.framed import box_to_frame, to_frame
from tusqh.geometry.soup import Soup
from tusqh.grid import BackgroundGrid
from tusqh.grid.slabs import cut
from tusqh.hashing import canonical_json, hash_value
from tusqh.pipeline.original import Original
from tusqh.pipeline.slabs.folder import WorkFolder
from tusqh.pipeline.slabs.fractions import SlabFractions, Survey
from tusqh.pipeline.slabs.limits import count_slabs
from tusqh.progress import Progress
from tusqh.sampling.fractions import require_samples
from tusqh.sampling.layout import lay_as_set
from tusqh.sampling.nothing_inside import nothing_inside
from tusqh.sampling.orient import orient
from tusqh.sampling.place import place_grid
from tusqh.sampling.placement import Placement
from tusqh.sampling.reference import Reference, find_reference, signed_volume
from tusqh.sampling.slab_sampler import SlabSampler
from tusqh.settings.model import Settings
from tusqh.settings.policy import Policy


@dataclass(frozen=True)
class Placed:
    """The grid of a surface in slabs, with its fractions, which are sampled when they are needed.

    Parameters
    ----------
    fractions
        The fractions.
    placement
        Where the grid was placed; None: at the corner, as requested.
    sign
        -1 if all winding numbers are negated.
    digests
        Digests of the fractions at the corner and, if they are others, where the grid was placed.
    survey
        What a pass over the fractions found; None: they have not been sampled.
    """

    fractions: SlabFractions
    placement: Placement | None
    sign: int
    digests: tuple[str, ...]
    survey: Survey | None = None


@dataclass(frozen=True)
class Sampled:
    """The fractions of a surface in slabs.

    Parameters
    ----------
    fractions
        The fractions.
    survey
        What one pass over them found.
    reference
        The volume that the mesh should have.
    placement
        Where the grid was placed; None: at the corner, as requested.
    policy
        How small features are treated.
    digests
        Digests of the fractions at the corner and, if they are others, where the grid was placed.
    """

    fractions: SlabFractions
    survey: Survey
    reference: Reference
    placement: Placement | None
    policy: Policy
    digests: tuple[str, ...]


class _Sampler:
    """Makes the fractions of grids in slabs."""

    def __init__(
        self, original: Original, settings: Settings, folder: WorkFolder, progress: Progress
    ) -> None:
        self.original, self.settings, self.folder = original, settings, folder
        surface, window = cast("Soup", original.geometry), original.window
        box = None if window is None else window.box
        self.laid = lay_as_set([surface], box, original.grid, original.sampling)
        self.geometry, self.box = cast("Soup", self.laid.surfaces[0]), self.laid.window
        self.oriented = cast("Soup", orient(self.geometry, original.sampling.orientation).geometry)
        self.progress = progress
        self.inputs = {
            "tusqh": __version__,
            "geometry": digest_of(self.oriented),
            "settings": original.to_dict(),
        }

    def fractions(self, grid: BackgroundGrid, n_slabs: int) -> tuple[SlabFractions, int]:
        """Return the fractions of a grid, which are sampled when they are needed, and the sign."""
        slabs = cut(grid, n_slabs)
        digest = hash_value(
            {**self.inputs, "grid": grid.to_dict(), "slabs": [list(slab) for slab in slabs]}
        )
        sampling = self.original.sampling
        require_samples(self.geometry, grid, sampling, self.box)
        sampler = sampler_of(self.original, grid)
        sign = self.folder.name("sign", digest, 0).with_suffix(".json")
        if sign.is_file():
            sampler.sign = int(json.loads(sign.read_text("utf-8")))
        else:
            tally = sampler.take_all()
            if not tally.is_nonzero:
                raise nothing_inside(self.geometry, sampling, grid.cell_size)
            write_text(sign, canonical_json(sampler.sign))
        found = SlabFractions(grid, slabs, sampling.samples, sampler.sample, self.folder, digest)
        return found, sampler.sign


def place_in_slabs(
    original: Original, settings: Settings, folder: WorkFolder, *, name: str, progress: Progress
) -> Placed:
    """Return the grid that the settings specify, which is sampled only to compare placements.

    Parameters
    ----------
    original, settings, folder, name, progress
        See `sample_in_slabs`.

    Raises
    ------
    SamplingError
        See `sample_in_slabs`.
    """
    sampler = _Sampler(original, settings, folder, progress)
    options, sampling = original.grid, original.sampling
    grid, placement = sampler.laid.grid, sampler.laid.placement
    volume = signed_volume(sampler.oriented) if sampling.domain == "inside" else None
    n_slabs = count_slabs(settings, grid, volume, name)
    fractions, sign = sampler.fractions(grid, n_slabs)
    if placement is not None or options.placement != "auto":
        return Placed(fractions, placement, sign, (fractions.digest,))
    threshold = threshold_of(settings)
    survey = take_survey(fractions, original, threshold, name=name, progress=progress)
    progress("placement")
    box = None if original.window is None else original.window.box
    reference = find_reference(original.geometry, survey, sampling=sampling, window=box)
    placed, placement = place_grid(
        sampler.oriented,
        survey,
        reference.volume,
        sampling=sampling,
        window=sampler.box,
        threshold=threshold,
    )
    if not placement.is_moved:
        return Placed(fractions, placement, sign, (fractions.digest,), survey)
    moved, sign = sampler.fractions(placed, n_slabs)
    return Placed(moved, placement, sign, (fractions.digest, moved.digest))


def sample_in_slabs(
    original: Original, settings: Settings, folder: WorkFolder, *, name: str, progress: Progress
) -> Sampled:
    """Return the fractions of a surface in slabs, on the grid that its settings specify.

    Parameters
    ----------
    original
        The surface, and the settings with which it is sampled.
    settings
        All settings; the threshold is given.
    folder
        Where finished slabs are kept.
    name
        The model, for messages.
    progress
        Shows how many slabs have been sampled.

    Raises
    ------
    SamplingError
        Grid, window and geometry do not match, nothing is inside, or the slabs do not fit.
    """
    placed = place_in_slabs(original, settings, folder, name=name, progress=progress)
    return complete(placed, original, settings, name=name, progress=progress)


def complete(
    placed: Placed, original: Original, settings: Settings, *, name: str, progress: Progress
) -> Sampled:
    """Return the fractions of a placed grid with what a pass over them finds.

    Parameters
    ----------
    placed
        The grid with its fractions.
    original, settings, name, progress
        See `sample_in_slabs`.

    Raises
    ------
    SamplingError
        Nothing is inside.
    """
    survey = placed.survey
    if survey is None:
        threshold = threshold_of(settings)
        survey = take_survey(placed.fractions, original, threshold, name=name, progress=progress)
    progress("placement")
    geometry = cast("Soup", original.geometry)
    box = None if original.window is None else original.window.box
    reference = find_reference(geometry, survey, sampling=original.sampling, window=box)
    return Sampled(
        placed.fractions, survey, reference, placed.placement, settings.policy, placed.digests
    )


def take_survey(
    fractions: SlabFractions, original: Original, threshold: float, *, name: str, progress: Progress
) -> Survey:
    """Return what one pass over fractions finds.

    Parameters
    ----------
    fractions, original
        See `complete`.
    threshold
        The threshold.
    name, progress
        See `complete`.

    Raises
    ------
    SamplingError
        Nothing is inside.
    """
    survey = fractions.survey(threshold, progress("samples"))
    if not survey.has_some:
        raise SamplingError(
            f"no cell of the {fractions.grid.label} grid has a positive fraction of the "
            f"{original.sampling.domain} of the geometry",
            where=name,
            expected="some material in the grid",
            remedy="use the other `domain`, `orientation: auto`, a finer grid or another window",
        )
    return survey


def sampler_of(original: Original, grid: BackgroundGrid) -> SlabSampler:
    """Return the sampler of a surface on a grid.

    Parameters
    ----------
    original
        The surface, and the settings with which it is sampled.
    grid
        The whole grid.
    """
    sampling, window = original.sampling, original.window
    surface = to_frame(cast("Soup", original.geometry), grid.frame)
    oriented = cast("Soup", orient(surface, sampling.orientation).geometry)
    box = box_to_frame(None if window is None else window.box, grid.frame)
    return SlabSampler.of(oriented, grid, sampling, box)


def original_of(geometry: Soup, settings: Settings) -> Original:
    """Return a surface with the settings with which it is sampled.

    Parameters
    ----------
    geometry
        The surface.
    settings
        All settings.
    """
    return Original(
        geometry,
        settings.grid,
        settings.sampling,
        settings.window,
        settings.quality,
        settings.goal.threshold,
    )


def threshold_of(settings: Settings) -> float:
    """Return the threshold that is given.

    Parameters
    ----------
    settings
        All settings, of which `require_possible` has found that a mesh in slabs can have them.
    """
    threshold = settings.goal.threshold
    assert threshold is not None
    return threshold


def digest_of(geometry: Soup) -> str:
    """Return a digest of the points and triangles of a surface.

    Parameters
    ----------
    geometry
        The surface.
    """
    found = hashlib.sha256()
    for array in (geometry.points, geometry.triangles):
        found.update(str((array.shape, array.dtype.str)).encode())
        found.update(np.ascontiguousarray(array).tobytes())
    return found.hexdigest()
