"""The original of a mesh of several materials: their geometries, and how they are sampled."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from tusqh.geometry.canonical import load_geometry, write_geometry
from tusqh.geometry.image import Image
from tusqh.geometry.kinds import Surface
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup import Soup
from tusqh.pipeline.materials.gather import Gathered
from tusqh.pipeline.materials.sample import Sampled, name_labels, sample_materials
from tusqh.settings.grid import Grid, Window
from tusqh.settings.materials import Material
from tusqh.settings.model import Settings
from tusqh.settings.sampling import Sampling
from tusqh.settings.section import to_plain


@dataclass(frozen=True)
class MaterialsOriginal:
    """The geometries of several materials, and the settings of their sampling.

    Parameters
    ----------
    gathered
        The surfaces by name, or the image of labels.
    grid, sampling, window
        See `tusqh.settings.model.Settings`.
    rest
        Name of the material that fills what the others leave; None: that is void.
    """

    gathered: Gathered = field(repr=False)
    grid: Grid
    sampling: Sampling
    window: Window | None = None
    rest: str | None = None

    def sample(self) -> Sampled:
        """Return the fractions of all materials."""
        settings = Settings(grid=self.grid, sampling=self.sampling, window=self.window)
        return sample_materials(self.gathered, settings, rest=self.rest)

    def save(self, path: Path) -> None:
        """Write all geometries as one canonical file, see `tusqh.geometry.canonical`.

        Parameters
        ----------
        path
            The file, with the suffix ``.vtp``.
        """
        image = self.gathered.image
        surfaces = list(self.gathered.surfaces.values())
        write_geometry(path, image if image is not None else join_surfaces(surfaces))

    def to_dict(self) -> dict[str, Any]:
        """Return everything but the geometries as plain values, without what is None.

        `surfaces` has the number of parts of each surface in the canonical file.
        """
        surfaces = self.gathered.surfaces
        labels = name_labels(self.gathered.wishes)
        sections = {
            "grid": self.grid,
            "sampling": self.sampling,
            "window": self.window,
            "rest": self.rest,
            "surfaces": [{"name": n, "parts": count_parts(s)} for n, s in surfaces.items()] or None,
            "labels": {str(label): name for label, name in labels.items()} or None,
        }
        return dict(to_plain(sections))

    @classmethod
    def load(cls, path: Path, settings: Mapping[str, Any]) -> MaterialsOriginal:
        """Return the original that `save` and `to_dict` described.

        Parameters
        ----------
        path
            The canonical file.
        settings
            The other values.

        Raises
        ------
        GeometryError
            The file cannot be read, or a surface has no part in it.
        """
        geometry, window = load_geometry(path), settings.get("window")
        labels = settings.get("labels", {})
        wishes = tuple(Material(name, label=int(label)) for label, name in labels.items())
        if isinstance(geometry, Image):
            gathered = Gathered(wishes, image=geometry)
        else:
            parts = {row["name"]: row["parts"] for row in settings["surfaces"]}
            gathered = Gathered((), split_surfaces(geometry, parts))
        return cls(
            gathered,
            Grid.from_dict(settings["grid"]),
            Sampling.from_dict(settings["sampling"]),
            window and Window.from_dict(window),
            settings.get("rest"),
        )


def count_parts(surface: Surface) -> int:
    """Return the number of parts of a soup, or of chains of an outline.

    Parameters
    ----------
    surface
        The soup or outline.
    """
    return len(np.unique(_numbers(surface)))


def join_surfaces(surfaces: list[Surface]) -> Surface:
    """Return surfaces of one dimension as one, with the parts of each after those of the others.

    Parameters
    ----------
    surfaces
        The surfaces, at least one.
    """
    n_points = np.cumsum([0, *(len(s.points) for s in surfaces)])
    n_parts = np.cumsum([0, *map(count_parts, surfaces)])
    points = np.concatenate([s.points for s in surfaces])
    simplices = np.concatenate(
        [_simplices(s) + first for s, first in zip(surfaces, n_points[:-1], strict=True)]
    )
    numbers = np.concatenate(
        [
            np.unique(_numbers(s), return_inverse=True)[1].ravel() + first
            for s, first in zip(surfaces, n_parts[:-1], strict=True)
        ]
    )
    kind = Outline if isinstance(surfaces[0], Outline) else Soup
    joined = kind(points, simplices, numbers.astype(np.int64), "materials")
    return replace(joined, unit=surfaces[0].unit)


def split_surfaces(geometry: Surface, parts: Mapping[str, int]) -> dict[str, Surface]:
    """Return the surfaces that `join_surfaces` joined, by name.

    Parameters
    ----------
    geometry
        What it returned.
    parts
        Number of parts of each surface, by name, in order.

    Examples
    --------
    >>> square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 0]])
    >>> two = [Outline.from_chains([square]), Outline.from_chains([square, square + 2])]
    >>> again = split_surfaces(join_surfaces(two), {"a": 1, "b": 2})
    >>> {name: surface.n_segments for name, surface in again.items()}
    {'a': 3, 'b': 6}
    """
    ends = np.cumsum([0, *parts.values()]).tolist()
    kind = Outline if isinstance(geometry, Outline) else Soup
    found: dict[str, Surface] = {}
    for name, low, high in zip(parts, ends[:-1], ends[1:], strict=True):
        numbers = _numbers(geometry)
        chosen = (numbers >= low) & (numbers < high)
        part = kind(geometry.points, _simplices(geometry)[chosen], numbers[chosen] - low, name)
        found[name] = replace(part, unit=geometry.unit)
    return found


def _numbers(surface: Any) -> Any:
    """Return the part of every triangle, or the chain of every segment."""
    return surface.chains if isinstance(surface, Outline) else surface.parts


def _simplices(surface: Any) -> Any:
    """Return the segments of an outline or the triangles of a soup."""
    return surface.segments if isinstance(surface, Outline) else surface.triangles
