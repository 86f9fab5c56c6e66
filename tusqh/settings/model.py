"""The combined settings of a mesh, of a model, and of the whole workflow."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

from tusqh.settings.coarsening import Coarsening
from tusqh.settings.field import setting
from tusqh.settings.fitting import Fitting
from tusqh.settings.goal import Goal
from tusqh.settings.grid import Grid, Window
from tusqh.settings.lengths import Lengths
from tusqh.settings.materials import Material, find_repeated
from tusqh.settings.memory import Memory
from tusqh.settings.policy import Policy
from tusqh.settings.quality import Quality
from tusqh.settings.sampling import Sampling
from tusqh.settings.section import Section
from tusqh.settings.simulation import Simulation
from tusqh.settings.validate import Path
from tusqh.settings.voxels import Voxels


@dataclass(frozen=True)
class Settings(Section):
    """Every setting that determines the mesh of a geometry, as taken by `tusqh.mesh`.

    Examples
    --------
    >>> Settings.from_dict({"grid": {"cells": 32}, "rule": "clamped"}).to_dict(defaults=False)
    {'grid': {'cells': 32}, 'rule': 'clamped'}
    """

    grid: Grid = setting(
        "The background grid: `{cells: n}` along the longest side, `{cells: [nx, ny]}`, or "
        "`{cell_size: h}` for squares or cubes, or `{cell_size: [hx, hy, hz]}` for boxes.",
        default=Grid,
        is_spread=True,
    )
    sampling: Sampling = setting(
        "How volume fractions are sampled.", default=Sampling, is_inline=True
    )
    window: Window | None = setting(
        "Box to mesh in, `{lower: [x, y], upper: [x, y]}` (in 3D with z); everything outside "
        "counts as empty.",
        default=None,
        otherwise="the bounding box",
        unit="units of the geometry",
        argument="window",
        metavar="X0,Y0,X1,Y1",
    )
    lengths: Lengths = setting("Units of length.", default=Lengths, is_inline=True)
    image: Voxels = setting(
        "What the voxels of an image mean; only for images.",
        default=Voxels,
        kinds=("image", "picture"),
    )
    goal: Goal = setting("How the threshold is chosen.", default=Goal, is_inline=True)
    policy: Policy = setting(
        "What to do about archipelagos and small features.", default=Policy, is_inline=True
    )
    fitting: Fitting = setting(
        "Whether the boundary is moved onto the geometry.", default=Fitting, is_inline=True
    )
    coarsening: Coarsening = setting(
        "Whether elements away from the boundary are coarser.", default=Coarsening, is_inline=True
    )
    quality: Quality = setting(
        "How far the mesh may be from its geometry.", default=Quality, is_inline=True
    )
    memory: Memory = setting(
        "How a mesh that does not fit into memory is made.", default=Memory, is_inline=True
    )

    def find_unavailable_in_slabs(self) -> Iterator[str]:
        """Yield what is asked for but needs the whole mesh, so that slabs do not have it."""
        for key in ("target", "persistence", "volume", "features"):
            if getattr(self.goal, key) is not None:
                yield f"`{key}`"
        if self.policy.bridges not in (None, "none"):
            yield "`bridges`"
        for key in ("components", "holes", "voids"):
            if not getattr(self.policy, key).keeps_all:
                yield f"`{key}`"
        if self.sampling.inside != "winding":
            yield "`inside`"
        if self.fitting.fit:
            yield "`fit`"
        if self.coarsening.coarsen is not None:
            yield "`coarsen`"
        if self.quality.checks is not None:
            yield "`checks: all`"

    def find_contradictions(self) -> Iterator[tuple[Path, str, str]]:
        """Yield values that contradict each other, also what needs cubes or axes not turned."""
        yield from super().find_contradictions()
        needs_cubes = {
            "fit": self.fitting.fit,
            "coarsen": self.coarsening.coarsen,
            "slabs": self.memory.slabs,
            f"inside: {self.sampling.inside}": self.sampling.inside != "winding",
        }
        needs_axes = {"window": self.window, "coarsen": self.coarsening.coarsen}
        if isinstance(self.grid.cell_size, tuple):
            for name in (name for name, value in needs_cubes.items() if value):
                found = f"found `{name}` and a `cell_size` of {len(self.grid.cell_size)} numbers"
                yield (), found, "one `cell_size`, for cells that are squares or cubes"
        if self.grid.is_turned:
            for name in (name for name, value in needs_axes.items() if value is not None):
                found = f"found `{name}` and a grid that is turned"
                yield (), found, "one of the two: it needs the axes of the coordinates"


@dataclass(frozen=True)
class Model(Section):
    """A model of the workflow: a block below `models` in the configuration."""

    geometry: str | None = setting(
        "Geometry file, relative to the repository, or `package:NAME/FILE` inside an installed "
        "Python package. 2D: GeoJSON, shapefile, SVG, DXF or CSV (`x0,y0,x1,y1`); 3D: STL, OBJ, "
        "PLY, OFF, GLB, VTK, VTU, VTP; images: NPY, TIFF, NRRD. It is neither repaired nor "
        "snapped nor closed.",
        default=None,
        otherwise="required unless every material has a `source`",
        extra={"minLength": 1},
    )
    materials: Literal["parts", "labels"] | tuple[Material, ...] | None = setting(
        "Mesh several materials: the `parts` of the geometry, the `labels` of an image, or a list; "
        "where two overlap, the earlier one has priority.",
        default=None,
        otherwise="one material",
    )
    labels: Mapping[str, str] | None = setting(
        "Names of the labels of an image, `{1: bone, 2: marrow}`, which is meshed as several "
        "materials.",
        default=None,
        otherwise="none",
    )
    rest: str | None = setting(
        "Name of the material that fills what the others leave of the grid or window.",
        default=None,
        otherwise="the rest is void",
    )
    up: Literal["x", "y", "z"] | None = setting(
        "3D: axis that points up in figures and in the explorer.",
        default=None,
        otherwise="`y` for OBJ and glTF, `z` for other formats",
        kinds=("surface", "image"),
    )
    settings: Settings = setting("How it is meshed.", default=Settings, is_inline=True)
    panels: tuple[float, ...] = setting(
        "2D: thresholds of the three panels of the threshold figure.",
        default=(0.5, 0.15, 0.01),
        above=0,
        at_most=1,
        n_items=(3, 3),
        kinds=("outline", "picture"),
    )
    simulation: Simulation = setting(
        "The release of a contaminant, in 3D of heat, and its diffusion.", default=Simulation
    )

    @property
    def has_several_materials(self) -> bool:
        """Whether it is meshed as several materials."""
        return self.materials is not None or self.labels is not None

    @property
    def list_of_materials(self) -> tuple[Material, ...]:
        """The materials for which something is given."""
        listed = self.materials if isinstance(self.materials, tuple) else ()
        named = [Material(name, label=int(label)) for label, name in (self.labels or {}).items()]
        return (*named, *listed)

    @property
    def files(self) -> tuple[str, ...]:
        """The geometry files of the model and of its materials, each once."""
        sources = [m.source for m in self.list_of_materials]
        return tuple(dict.fromkeys(f for f in (self.geometry, *sources) if f is not None))

    def find_contradictions(self) -> Iterator[tuple[Path, str, str]]:
        """Yield a missing geometry, and names, labels or wishes that contradict each other."""
        yield from super().find_contradictions()
        if self.geometry is None and not self.files:
            yield (), "the key 'geometry' is missing", "a geometry file"
        for label in self.labels or {}:
            if not label.lstrip("-").isdecimal():
                yield ("labels", label), f"found {label!r}", "a whole number for each label"
                return
        listed = self.materials if isinstance(self.materials, tuple) else ()
        for k, material in enumerate(listed):
            for path, found, expected in material.find_contradictions():
                yield ("materials", k, *path), found, expected
        for path, found, expected in find_repeated(self.list_of_materials):
            yield ("materials", *path), found, expected
        if self.has_several_materials and self.settings.fitting.fit:
            yield ("fit",), "found True", "false: several materials are not fitted yet"
        if self.has_several_materials and self.settings.coarsening.coarsen is not None:
            found = f"found {self.settings.coarsening.coarsen!r}"
            yield ("coarsen",), found, "none: several materials are not coarsened yet"
        if self.settings.memory.slabs is not None:
            wrong = list(self.settings.find_unavailable_in_slabs())
            wrong += ["several materials"] if self.has_several_materials else []
            if wrong:
                found = f"found {self.settings.memory.slabs!r} with {' and '.join(wrong)}"
                yield ("slabs",), found, "a threshold, and nothing that needs the whole mesh"
        if self.rest is not None and not self.has_several_materials:
            yield ("rest",), f"found {self.rest!r}", "`materials` or `labels` beside it"


@dataclass(frozen=True)
class Study(Section):
    """The extent of the studies of the models."""

    placements: int = setting(
        "Random orientations and offsets of every model.", default=20, at_least=2
    )
    cells_2d: tuple[int, ...] = setting(
        "Cells along the longest side of the grids laid over 2D models; the largest is a "
        "multiple of the others.",
        default=(24, 48, 96),
        at_least=1,
        is_distinct=True,
    )
    cells_3d: tuple[int, ...] = setting(
        "The same for 3D models.", default=(16, 32), at_least=1, is_distinct=True
    )
    peers: tuple[str, ...] | None = setting(
        "3D models that other programs mesh too, for the table of peers.",
        otherwise="all 3D models",
        default=None,
        is_distinct=True,
    )
    seconds: int = setting(
        "Processor time after which a program that Tusqh is compared with counts as not finished.",
        default=90,
        unit="s",
        at_least=1,
    )
    fit: bool = setting(
        "Whether the slow studies of fitting run: distances over the cell, and creases of solids.",
        default=False,
    )


@dataclass(frozen=True)
class Workflow(Section):
    """The configuration of the workflow: the keys at the top of ``config/config.yaml``."""

    models: Mapping[str, Model] = setting(
        "The models, by name; the name becomes the folder `results/<name>/`.",
        extra={
            "minProperties": 1,
            "propertyNames": {
                "pattern": "^[A-Za-z0-9][A-Za-z0-9_-]*$",
                "not": {
                    "enum": [
                        *("tables", "provenance", "report", "figures"),
                        *("benchmarks", "logs", "code", "workflow"),
                    ]
                },
            },
        },
    )
    sweep: tuple[float, ...] = setting(
        "Thresholds at which the topology of every 2D model is verified, as rows of "
        "`verification.csv`.",
        default=(0.9, 0.75, 0.5, 0.25, 0.15, 0.05, 0.01),
        above=0,
        at_most=1,
        is_distinct=True,
    )
    sweep_3d: tuple[float, ...] = setting(
        "The same for 3D models, and the panels of their figure.",
        default=(0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0),
        above=0,
        at_most=1,
        is_distinct=True,
    )
    snapshots: tuple[int, ...] = setting(
        "Time steps at which the simulated field is written; the last one ends the simulation.",
        default=(0, 50, 100, 200, 400, 800),
        at_least=0,
        n_items=(6, 6),
        is_distinct=True,
    )
    study: Study = setting("How much the studies of the models do.", default=Study)
    split: int = setting(
        "Jobs among which the placements of a model are divided. With more than one, each "
        "threshold of a sweep is a job of its own too, which suits a cluster.",
        default=1,
        at_least=1,
    )
