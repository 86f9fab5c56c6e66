"""The volume fractions of a grid in slabs on disk, and what one pass over them finds."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from tusqh.grid import BackgroundGrid, BoolArray, FloatArray, IntArray
from tusqh.grid.slabs import PackedBits, Slab
from tusqh.pipeline.slabs.folder import WorkFolder
from tusqh.sampling.doubled_grid import RESOLUTION, Multiples
from tusqh.sampling.fractions import VolumeFractions, to_level
from tusqh.sampling.io import load_fractions, save_fractions
from tusqh.sampling.place import levels_near
from tusqh.topology.clamping import FULL


@dataclass
class Survey:
    """What one pass over the fractions finds, for one threshold.

    Parameters
    ----------
    grid
        The whole grid.
    samples
        Samples along each side of a cell.
    threshold
        The threshold.
    """

    grid: BackgroundGrid
    samples: int
    threshold: float
    is_interior: PackedBits = field(init=False)
    kept: BoolArray = field(init=False)
    has_some: bool = False
    lower: int = 0
    upper: int = FULL
    _ties: int = 0
    _total: int = 0
    _counts: IntArray = field(init=False)

    def __post_init__(self) -> None:
        self.is_interior = PackedBits(tuple(2 * n + 1 for n in self.grid.shape))
        self.kept = np.zeros(self.grid.shape, dtype=bool)
        self._counts = np.zeros(3, dtype=np.int64)

    @property
    def _levels(self) -> FloatArray:
        """The fractions for which cells are counted."""
        return levels_near(self.threshold, self.samples**self.grid.dim)

    def add(self, slab: Slab, multiples: Multiples) -> None:
        """Take account of a slab.

        Parameters
        ----------
        slab
            The slab.
        multiples
            Its fractions, the rows ``slab.rows`` of the doubled grid.
        """
        level = to_level(self.threshold)
        cells = multiples[1::2, 1::2, 1::2]
        self.is_interior.set_rows(slab.rows.start, multiples >= level)
        self.kept[slab.begin : slab.end] = cells >= level
        self.has_some |= bool((cells > 0).any())
        self._ties += int((cells == level).sum())
        self._total += int(cells.sum(dtype=np.int64))
        self._counts += [int((cells >= to_level(at)).sum()) for at in self._levels]
        within = cells.clip(0, FULL)
        self.lower = int(within.max(where=within < level, initial=self.lower))
        self.upper = int(within.min(where=within >= level, initial=self.upper))

    def volume(self) -> float:
        """Return the volume that the cell fractions add up to, in model units."""
        return self._total * RESOLUTION * self.grid.cell_size**self.grid.dim

    def count_at_least(self, thresholds: FloatArray) -> IntArray:
        """Return the number of cells with at least each of the fractions near the threshold.

        Parameters
        ----------
        thresholds
            The fractions of `tusqh.sampling.place.levels_near` for the threshold.
        """
        assert np.array_equal(thresholds, self._levels)
        return self._counts

    def count_ties(self, threshold: float) -> int:
        """Return the number of cells whose fraction is the threshold itself.

        Parameters
        ----------
        threshold
            The threshold of the survey.
        """
        assert threshold == self.threshold
        return self._ties


@dataclass(frozen=True)
class SlabFractions:
    """Volume fractions in slabs, which are made when they are first needed.

    Parameters
    ----------
    grid
        The whole grid.
    slabs
        Its slabs.
    samples
        Samples along each side of a cell.
    sample
        Returns the fractions of a slab.
    folder, digest
        Where they are kept, and the digest of everything on which they depend.
    """

    grid: BackgroundGrid
    slabs: list[Slab]
    samples: int
    sample: Callable[[Slab], Multiples] = field(repr=False)
    folder: WorkFolder
    digest: str

    def multiples(self, slab: Slab) -> Multiples:
        """Return the fractions of a slab, from its file if that is there.

        Parameters
        ----------
        slab
            The slab.
        """
        path = self.folder.name("fractions", self.digest, slab.number)
        if path.is_file():
            return load_fractions(path).multiples
        multiples = self.sample(slab)
        save_fractions(path, VolumeFractions(slab.grid(self.grid), self.samples, multiples))
        return multiples

    def survey(self, threshold: float, report: Callable[[int, int], None] | None = None) -> Survey:
        """Return what one pass over all slabs finds.

        Parameters
        ----------
        threshold
            The threshold.
        report
            Called with (slabs done, slabs in all).
        """
        found = Survey(self.grid, self.samples, threshold)
        for slab, multiples in self._each():
            found.add(slab, multiples)
            if report is not None:
                report(slab.number + 1, len(self.slabs))
        return found

    def _each(self) -> Iterator[tuple[Slab, Multiples]]:
        for slab in self.slabs:
            yield slab, self.multiples(slab)
