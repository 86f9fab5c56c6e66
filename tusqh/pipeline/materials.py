"""Run all stages for several materials, from an image of labels to a measured mesh."""

from __future__ import annotations

from pathlib import Path

from tusqh.contacts import MaterialMesh, fractions_of_labels, mesh_materials
from tusqh.errors import ConfigError, GeometryError
from tusqh.geometry.image import Image
from tusqh.pipeline.ingest import read_source
from tusqh.readers.labels import as_whole_numbers
from tusqh.sampling.voxels import lay_on_voxels
from tusqh.settings.model import Settings


def mesh_label_file(path: str, settings: Settings) -> MaterialMesh:
    """Return the mesh of all materials in an image file of labels; label 0 is the void.

    Parameters
    ----------
    path
        An image whose voxels are labels.
    settings
        Only its grid, the size of voxels and the channel have an effect.

    Raises
    ------
    ConfigError
        A given setting has no effect here.
    GeometryError
        The file is not an image of integers.
    SamplingError
        No voxel has a material.
    """
    _require_no_others(settings)
    # By default, voxels between 0 and 1 are grey values; these options keep labels unchanged.
    meaning = {**settings.image.to_dict(), "empty": 0.0, "full": 1.0}
    image = read_source(path, image=meaning).geometry
    labels = as_whole_numbers(image.voxels) if isinstance(image, Image) else None
    if not isinstance(image, Image) or labels is None:
        raise GeometryError(
            "a file that is not an image of labels",
            where=path,
            expected="an image (NPY, TIFF, NRRD) whose voxels are whole numbers",
            remedy="leave out --materials to mesh it as one material",
        )
    grid = lay_on_voxels(image, cells=settings.grid.cells, cell_size=settings.grid.cell_size)
    fractions = fractions_of_labels(
        labels,
        voxels_per_cell=round(grid.cell_size / image.voxel_size),
        voxel_size=image.voxel_size,
        origin=image.origin,
        void=0,
    )
    return mesh_materials(fractions, name=Path(path).stem)


def _require_no_others(settings: Settings) -> None:
    """Raise a `ConfigError` if a given setting does not apply to several materials."""
    default = Settings()
    names = ("goal", "window", "sampling", "policy")
    given = [n for n in names if getattr(settings, n) != getattr(default, n)]
    image = ("empty", "full", "labels")
    given += [f"image.{n}" for n in image if getattr(settings.image, n) is not None]
    if given:
        raise ConfigError(
            f"settings of {', '.join(given)} together with several materials",
            where="--materials",
            expected="only the grid, the voxel size and the channel",
            remedy="leave the others out, or leave out --materials",
        )
