"""The steps of a mesh in slabs as the workflow runs them: each slab is a job of its own.

`lay` determines grid and slabs, `sample_slab` samples one, `decide` decides all contacts,
`emit_elements` makes the elements of one slab and `write_piece_of` its piece, and `merge` measures
and certifies the whole.  They do what `tusqh.pipeline.slabs.mesh.mesh_in_slabs` does in one go.
"""

from __future__ import annotations

import json
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from tusqh.contacts.one_material import VOID
from tusqh.contacts.slab_elements import emit_window
from tusqh.errors import ConfigError
from tusqh.grid import BackgroundGrid
from tusqh.grid.slabs import LEAST, Slab, cut
from tusqh.meshes.measure_pieces import measure_pieces
from tusqh.meshes.piece_files import read_pieces
from tusqh.pipeline.original import Original
from tusqh.pipeline.report import Report
from tusqh.pipeline.slabs.cells import SlabCells
from tusqh.pipeline.slabs.certificate import FRACTIONS_FOLDER
from tusqh.pipeline.slabs.elements import SlabMesh, write_elements
from tusqh.pipeline.slabs.folder import WorkFolder
from tusqh.pipeline.slabs.found import Found
from tusqh.pipeline.slabs.fractions import SlabFractions
from tusqh.pipeline.slabs.limits import require_possible
from tusqh.pipeline.slabs.sample import (
    Placed,
    complete,
    place_in_slabs,
    sampler_of,
    take_survey,
)
from tusqh.pipeline.slabs.windows import read_window, write_windows
from tusqh.pipeline.slabs.write import name_pieces, piece_paths, write_slab
from tusqh.progress import log_progress
from tusqh.sampling.placement import Placement
from tusqh.settings.memory import Memory
from tusqh.settings.model import Settings

#: Where the slabs of each kind are, below the folder of a model.
_PLACES = {"fractions": FRACTIONS_FOLDER, "elements": "slabs/elements"}


class StepFolder(WorkFolder):
    """The folder of a model in the workflow, which knows itself when a slab must be made again."""

    def name(self, kind: str, digest: str, number: int) -> Path:
        """Return the path of a slab, see `WorkFolder.name`.

        Parameters
        ----------
        kind
            What it holds.
        digest
            Not used.
        number
            Number of the slab.
        """
        return self.path / _PLACES[kind] / f"{number:04d}.npz"


@dataclass(frozen=True)
class Layout:
    """The grid of a mesh in slabs.

    Parameters
    ----------
    grid
        The whole grid.
    n_slabs
        Number of slabs.
    samples
        Samples along each side of a cell.
    sign
        -1 if all winding numbers are negated.
    placement
        Where the grid was placed; None: at the corner, as requested.
    """

    grid: BackgroundGrid
    n_slabs: int
    samples: int
    sign: int
    placement: Placement | None

    @property
    def slabs(self) -> list[Slab]:
        """The slabs."""
        return cut(self.grid, self.n_slabs)

    def fractions(self, folder: Path, original: Original | None = None) -> SlabFractions:
        """Return the fractions of all slabs, which are read from the folder of the model.

        Parameters
        ----------
        folder
            The folder of the model.
        original
            The surface, with which missing slabs are sampled; None: all slabs are there.
        """

        def sample(slab: Slab) -> Any:
            assert original is not None, slab
            sampler = sampler_of(original, self.grid)
            sampler.sign = self.sign
            return sampler.sample(slab)

        return SlabFractions(self.grid, self.slabs, self.samples, sample, StepFolder(folder), "")

    def mesh(self, folder: Path) -> SlabMesh:
        """Return the mesh, of which all slabs are in the folder of the model.

        Parameters
        ----------
        folder
            The folder of the model.
        """
        mesh = SlabMesh(self.grid, self.slabs, None, StepFolder(folder), "")
        mesh.make()
        return mesh

    def to_dict(self) -> dict[str, Any]:
        """Return the layout as plain values, for JSON."""
        return {
            "grid": self.grid.to_dict(),
            "slabs": self.n_slabs,
            "samples": self.samples,
            "sign": self.sign,
            "placement": self.placement and self.placement.to_dict(),
        }

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> Layout:
        """Return the layout that `to_dict` described.

        Parameters
        ----------
        values
            The fields by name.
        """
        placement = values["placement"]
        return cls(
            BackgroundGrid.from_dict(values["grid"]),
            values["slabs"],
            values["samples"],
            values["sign"],
            placement and Placement.from_dict(placement),
        )


def read_layout(path: Path) -> Layout:
    """Return the layout in a file.

    Parameters
    ----------
    path
        The JSON file.
    """
    return Layout.from_dict(json.loads(path.read_text("utf-8")))


def lay(original: Original, settings: Settings, n_slabs: int, folder: Path, *, name: str) -> Layout:
    """Return the grid of a mesh in slabs, placed as its settings ask for.

    Parameters
    ----------
    original
        The surface, and the settings with which it is sampled.
    settings
        All settings.
    n_slabs
        Number of slabs.
    folder
        Where slabs are kept while placements are compared.
    name
        The model, for messages.

    Raises
    ------
    ConfigError
        A setting is not available in slabs, or the grid is too thin for so many.
    SamplingError
        The slabs do not fit into memory, or nothing is inside.
    """
    require_possible(settings, original.geometry, name)
    settings = replace(settings, memory=Memory(slabs=n_slabs))
    with tempfile.TemporaryDirectory(dir=folder) as temporary:
        work = WorkFolder(Path(temporary))
        placed = place_in_slabs(original, settings, work, name=name, progress=log_progress)
    found = placed.fractions
    if len(found.slabs) != n_slabs:
        raise ConfigError(
            f"{n_slabs} slabs of a grid with {found.grid.shape[0]} cells along x",
            where=name,
            expected=f"slabs of at least {LEAST} cells, since each of them is a job",
            remedy=f"`slabs: {len(found.slabs)}`, or less",
        )
    return Layout(found.grid, n_slabs, found.samples, placed.sign, placed.placement)


def decide(layout: Layout, original: Original, folder: Path, path: Path, *, name: str) -> SlabCells:
    """Write the decisions at all contacts, and return the kept cells.

    Parameters
    ----------
    layout
        The grid.
    original
        The surface, and the settings with which it was sampled.
    folder
        The folder of the model, with the fractions of all slabs.
    path
        File to write, see `tusqh.pipeline.slabs.windows.write_windows`.
    name
        The model, for messages.

    Returns
    -------
    cells
        The kept cells.

    Raises
    ------
    ConfigError
        A slab has no kept cells, so that it would have no piece.
    """
    fractions = layout.fractions(folder)
    threshold = original.threshold
    assert threshold is not None
    survey = take_survey(fractions, original, threshold, name=name, progress=log_progress)
    cells = SlabCells.of(survey, name)
    for slab in layout.slabs:
        if not cells.kept[slab.begin : slab.end].any():
            raise ConfigError(
                f"slab {slab.number} of {layout.n_slabs} has no kept cells",
                where=name,
                expected="elements in every slab, since each of them is a job",
                remedy="use fewer `slabs`, or a `window` around the geometry",
            )
    write_windows(path, cells.decision, layout.grid, layout.slabs)
    return cells


def emit_elements(layout: Layout, contacts: Path, number: int, path: Path) -> None:
    """Write the elements of a slab.

    Parameters
    ----------
    layout
        The grid.
    contacts
        The file of `decide`.
    number
        Number of the slab.
    path
        File to write.
    """
    slab = layout.slabs[number]
    window = read_window(contacts, layout.grid, slab)
    write_elements(path, emit_window(window, layout.grid, slab, left_out=VOID))


def write_piece_of(layout: Layout, folder: Path, number: int, path: Path) -> None:
    """Write the piece of a slab.

    Parameters
    ----------
    layout
        The grid.
    folder
        The folder of the model, with the elements of all slabs.
    number
        Number of the slab.
    path
        File to write.
    """
    write_slab(path, layout.slabs[number], layout.mesh(folder), layout.fractions(folder))


def merge(
    layout: Layout,
    original: Original,
    settings: Settings,
    folder: Path,
    *,
    reading: dict[str, Any],
    name: str,
) -> Report:
    """Measure and certify a mesh of which all pieces are written, and return its report.

    Parameters
    ----------
    layout
        The grid.
    original, settings
        The surface and its settings.
    folder
        The folder of the model.
    reading
        What was read.
    name
        The model.

    Returns
    -------
    report
        The report.
    """
    path = folder / "mesh.pvtu"
    name_pieces(path, piece_paths(path, layout.n_slabs))
    measured = measure_pieces(read_pieces(path), name=name)
    placed = Placed(layout.fractions(folder), layout.placement, layout.sign, ())
    sampled = complete(placed, original, settings, name=name, progress=log_progress)
    cells = SlabCells.of(sampled.survey, name)
    found = Found(original, sampled, cells, measured, name)
    report = found.report(reading, ())
    found.certify(folder, report)
    return report
