"""Sample the fractions of several materials on one background grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from tusqh.contacts import MaterialFractions, fractions_of_labels
from tusqh.contacts.material_fractions import ALL, VOID
from tusqh.contacts.surface_fractions import fractions_of_surfaces
from tusqh.errors import ConfigError, GeometryError
from tusqh.geometry.image import Image
from tusqh.geometry.kinds import Surface
from tusqh.grid import FloatArray
from tusqh.pipeline.materials.gather import Gathered, require_known
from tusqh.sampling.layout import lay_as_set
from tusqh.sampling.memory import require_memory
from tusqh.sampling.placement import Placement
from tusqh.sampling.voxels import lay_on_voxels
from tusqh.settings.materials import Material
from tusqh.settings.model import Settings


@dataclass(frozen=True)
class Sampled:
    """The fractions of several materials, and where their geometries overlap.

    Parameters
    ----------
    fractions
        Fractions of all materials.
    overlaps
        Entry (i, j) is the volume of material j that material i, which comes earlier, took, in
        model units, shape (m, m); None for labels, which do not overlap.
    left_out
        Optional materials without a sample in the window.
    placement
        How `snap` or `offset` placed the grid; None if they are not set.
    """

    fractions: MaterialFractions
    overlaps: FloatArray | None = None
    left_out: tuple[str, ...] = ()
    placement: Placement | None = None


def sample_materials(gathered: Gathered, settings: Settings, *, rest: str | None = None) -> Sampled:
    """Return the fractions of several materials on the grid that their settings specify.

    Parameters
    ----------
    gathered
        The materials.
    settings
        The settings of the grid, the sampling, the window and the voxels.
    rest
        Name of the material that fills what the others leave of the grid or window; None: that is
        void.

    Raises
    ------
    ConfigError
        The name of the rest is that of a material.
    GeometryError
        The materials are partly in the plane and partly in space.
    SamplingError
        A material has no sample, or lies wholly inside earlier ones; or labels are unusable.
    """
    if rest is not None and rest in (*gathered.surfaces, VOID, ALL):
        raise ConfigError(
            f"the rest is called {rest!r}",
            where="rest",
            expected="a name that no other material has",
            remedy="choose another name",
        )
    if gathered.image is not None:
        return _sample_labels(gathered.image, gathered, settings, rest)
    surfaces = list(gathered.surfaces.values())
    _require_one_dimension(surfaces)
    window = None if settings.window is None else settings.window.box
    laid = lay_as_set(surfaces, window, settings.grid, settings.sampling)
    require_memory(laid.grid, "meshing of several materials", name="materials")
    found = fractions_of_surfaces(
        dict(zip(gathered.surfaces, laid.surfaces, strict=True)),
        laid.grid,
        sampling=settings.sampling,
        window=laid.window,
        rest=rest,
        optional=gathered.optional if window is not None else (),
    )
    left_out = tuple(n for n in gathered.surfaces if n not in found.fractions.names)
    return Sampled(found.fractions, found.overlaps, left_out, laid.placement)


def name_labels(wishes: Sequence[Material], rest: str | None = None) -> dict[int, str]:
    """Return the names of labels that materials and the rest give.

    Parameters
    ----------
    wishes
        The materials.
    rest
        Name of label 0, which otherwise is the void.
    """
    names = {m.label: m.name for m in wishes if m.label is not None}
    return names if rest is None else {0: rest, **names}


def _sample_labels(
    image: Image, gathered: Gathered, settings: Settings, rest: str | None
) -> Sampled:
    """Return the fractions of labels; label 0 is the void if it has no name."""
    grid = lay_on_voxels(image, cells=settings.grid.cells, cell_size=settings.grid.cell_size)
    names = name_labels(gathered.wishes, rest)
    fractions = fractions_of_labels(
        image.voxels,
        voxels_per_cell=round(grid.cell_size / image.voxel_size),
        voxel_size=image.voxel_size,
        origin=image.origin,
        names=names,
        void=None if 0 in names else 0,
    )
    require_known(gathered.wishes, fractions.names)
    of_unit = replace(fractions.grid, unit=image.unit)
    return Sampled(replace(fractions, grid=of_unit))


def _require_one_dimension(surfaces: Sequence[Surface]) -> None:
    """Raise an error if some surfaces are in the plane and others in space."""
    if len({len(surface.bounding_box()[0]) for surface in surfaces}) > 1:
        raise GeometryError(
            "outlines in the plane and surfaces in space",
            where="materials",
            expected="materials of one dimension",
            remedy="leave out one of the two kinds",
        )
