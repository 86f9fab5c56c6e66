"""The elements of slabs on disk, and their numbers in the whole mesh."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, fields
from pathlib import Path

import numpy as np

from tusqh.contacts.one_material import VOID
from tusqh.contacts.slab_elements import SlabElements, emit_slab
from tusqh.contacts.spatial import SpatialDecision
from tusqh.grid import BackgroundGrid, IntArray
from tusqh.grid.slabs import Slab
from tusqh.meshes.seams import Piece
from tusqh.pipeline.slabs.folder import WorkFolder, write_plain


def write_elements(path: Path, found: SlabElements) -> None:
    """Write the elements of a slab; the file appears complete or not at all.

    Parameters
    ----------
    path
        The npz file.
    found
        The elements.
    """
    write_plain(path, {f.name: getattr(found, f.name) for f in fields(found)})


@dataclass
class SlabMesh:
    """A mesh in slabs on disk.

    Parameters
    ----------
    grid
        The whole grid.
    slabs
        Its slabs.
    decide
        Returns the decision of the whole grid; None if all slabs are there.
    folder, digest
        Where slabs are kept, and the digest of everything on which they depend.
    """

    grid: BackgroundGrid
    slabs: list[Slab]
    decide: Callable[[], SpatialDecision] | None = field(repr=False)
    folder: WorkFolder
    digest: str
    _offsets: IntArray = field(init=False, repr=False)
    sizes: list[int] = field(default_factory=list)
    n_points: int = 0

    def make(self, report: Callable[[int, int], None] | None = None) -> None:
        """Emit the slabs that are not there yet, and number all points.

        Parameters
        ----------
        report
            Called with (slabs done, slabs in all).
        """
        counts = []
        for slab in self.slabs:
            path = self.folder.name("elements", self.digest, slab.number)
            if not path.is_file():
                assert self.decide is not None, path
                found = emit_slab(self.decide(), self.grid, slab, left_out=VOID)
                write_elements(path, found)
            with np.load(path) as content:
                counts.append(content["counts"])
                self.sizes.append(len(content["kind"]))
            if report is not None:
                report(slab.number + 1, len(self.slabs))
        table = np.array(counts)
        by_block = table.sum(axis=0)
        self.n_points = int(by_block.sum())
        # The numbers of a block follow those of the blocks before, and of the slabs before.
        self._offsets = np.cumsum(by_block) - by_block + np.cumsum(table, axis=0) - table

    @property
    def n_cells(self) -> int:
        """Number of elements."""
        return sum(self.sizes)

    def piece(self, slab: Slab) -> Piece:
        """Return the elements of a slab, with numbers of the whole mesh.

        Parameters
        ----------
        slab
            The slab.
        """
        with np.load(self.folder.name("elements", self.digest, slab.number)) as content:
            found = SlabElements(**{f.name: content[f.name] for f in fields(SlabElements)})
        numbers = self._offsets[slab.number][found.block] + found.place
        return Piece(found.points, numbers, found.cells, found.kind, found.grid_cell)

    def pieces(self) -> Iterator[Piece]:
        """Yield the pieces with elements, in order."""
        for slab, size in zip(self.slabs, self.sizes, strict=True):
            if size:
                yield self.piece(slab)
