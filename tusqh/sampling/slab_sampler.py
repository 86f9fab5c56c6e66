"""The fractions of one slab of a grid, equal in every bit to those of the whole grid."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from tusqh.geometry.kinds import Surface
from tusqh.grid import BackgroundGrid, FloatArray
from tusqh.grid.slabs import Slab
from tusqh.sampling.doubled_grid import Multiples, average_coverage, average_rows
from tusqh.sampling.field import WindingField, make_field
from tusqh.sampling.half_blocks import Tally, chunks_of, clipped_sums, sums_by_chunk
from tusqh.sampling.lattice import Box, Lattice
from tusqh.settings.sampling import Sampling


@dataclass
class SlabSampler:
    """The sampler of the slabs of a grid in space.

    Parameters
    ----------
    winding
        The winding number of the geometry.
    lattice
        The samples.
    sampling
        How fractions are sampled.
    sign
        -1 if all winding numbers are negated.
    """

    winding: WindingField
    lattice: Lattice
    sampling: Sampling
    sign: int = 1
    _last: tuple[int, FloatArray] = field(default=(-1, np.empty((0, 0, 0))), repr=False)

    @classmethod
    def of(
        cls, geometry: Surface, grid: BackgroundGrid, sampling: Sampling, window: Box | None
    ) -> SlabSampler:
        """Return the sampler of a geometry.

        Parameters
        ----------
        geometry
            The geometry, its parts turned.
        grid
            The whole grid.
        sampling
            How fractions are sampled.
        window
            Box, in model units; samples outside it count as void.
        """
        lattice = Lattice.over_grid(grid, sampling.samples, window)
        winding = make_field(geometry, sampling.sampler, tolerance=sampling.tolerance)
        return cls(winding, lattice, sampling)

    def take_all(self) -> Tally:
        """Return the tally of all samples, and set the sign that follows from it."""
        tally = Tally(float(self.lattice.half.prod()))
        for _ in sums_by_chunk(self.winding, self.lattice, tally):
            pass
        self.sign = tally.sign(self.sampling.orientation)
        return tally

    def sample(self, slab: Slab) -> Multiples:
        """Return the fractions of a slab.

        Parameters
        ----------
        slab
            The slab.

        Returns
        -------
        multiples
            The rows ``slab.rows`` of the fractions of the whole grid.
        """
        first, last = slab.rows.start, slab.rows.stop
        _, n_y, n_z = (int(n) for n in self.lattice.n_blocks)
        multiples = np.empty((last - first, n_y + 1, n_z + 1), dtype=np.int32)
        before = np.empty((0, n_y, n_z))
        at = 0
        for sums in self._columns(first - 1, last):
            joined = np.concatenate([before, sums])
            rows = average_rows(joined, self.lattice)
            multiples[at : at + len(rows)] = rows
            at, before = at + len(rows), joined[-1:]
        if self.sampling.rule == "average":
            np.multiply(multiples, self.sign, out=multiples)
            if self.sampling.domain == "outside":
                covered = average_coverage(self.lattice, slab.rows)
                np.subtract(covered, multiples, out=multiples)
        return multiples

    def _columns(self, first: int, last: int) -> Iterator[FloatArray]:
        """Yield the sums over the half-blocks ``first <= i < last``; 0 outside the lattice."""
        n_x, n_y, n_z = (int(n) for n in self.lattice.n_blocks)
        nothing = np.zeros((1, n_y, n_z))
        if first < 0:
            yield nothing
        for number, (begin, end) in enumerate(chunks_of(self.lattice, self.sampling.rule)):
            if begin < last and end > first:
                sums = self._chunk(number, (begin, end))
                yield sums[max(first - begin, 0) : last - begin]
        if last > n_x:
            yield nothing

    def _chunk(self, number: int, chunk: tuple[int, int]) -> FloatArray:
        """Return the sums over a chunk; the last one is remembered for the next slab."""
        if self._last[0] != number:
            if self.sampling.rule == "average":
                sums = self.winding.sums(self.lattice, *chunk)
            else:
                domain = self.sampling.domain
                sums = clipped_sums(self.winding, self.lattice, self.sign, domain, chunk)
            self._last = (number, sums)
        return self._last[1]
