"""Sums over half-blocks of the lattice, in chunks along x that bound memory.

The chunks depend on the lattice alone.  A slab of a large grid takes the sums of the same chunks,
so its fractions equal those of the whole grid in every bit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from tusqh.errors import SamplingError
from tusqh.grid import FloatArray
from tusqh.sampling.doubled_grid import RESOLUTION
from tusqh.sampling.field import WindingField
from tusqh.sampling.lattice import Lattice
from tusqh.settings.sampling import Domain, Orientation, Rule

#: About how many samples a chunk of the lattice holds: this bounds memory and paces progress.
SAMPLES_AT_A_TIME = 8_000_000

#: Largest winding number whose sums fit in 32 bits.
_LARGEST = 2000

Progress = Callable[[int, int], None]


@dataclass
class Tally:
    """The sum and the extremes of the winding numbers of all samples.

    Parameters
    ----------
    per_block
        Number of samples in a half-block.
    total
        Sum of the winding numbers so far.
    is_nonzero
        Whether one of them so far was not 0.
    """

    per_block: float
    total: float = 0.0
    is_nonzero: bool = False

    def add(self, sums: FloatArray) -> None:
        """Take account of the sums over some half-blocks.

        Parameters
        ----------
        sums
            Sums over the samples of half-blocks, any shape.

        Raises
        ------
        SamplingError
            A winding number is too large for 32 bits.
        """
        self.total += float(sums.sum())
        largest = max(float(sums.max(initial=0.0)), -float(sums.min(initial=0.0)))
        self.is_nonzero |= largest > RESOLUTION * self.per_block
        if largest > self.per_block * _LARGEST:
            raise SamplingError(
                f"a winding number of {largest / self.per_block:.0f}",
                where="samples",
                expected=f"at most {_LARGEST}",
                remedy="remove copies: the geometry covers the same place that many times",
            )

    def sign(self, orientation: Orientation) -> int:
        """Return -1 if all winding numbers must be negated, otherwise 1.

        Parameters
        ----------
        orientation
            How parts that are inside out are treated.
        """
        is_flipped = orientation == "flip" or (orientation == "auto" and self.total < 0)
        return -1 if is_flipped else 1


def chunks_of(lattice: Lattice, rule: Rule) -> list[tuple[int, int]]:
    """Return the ranges of half-blocks along x whose sums are computed together.

    Parameters
    ----------
    lattice
        The samples.
    rule
        With ``"clamped"`` every sample is evaluated, so that fewer of them fit.
    """
    n_x, n_y, n_z = (int(n) for n in lattice.n_blocks)
    if rule == "average":
        columns = max(16, SAMPLES_AT_A_TIME // (n_y * n_z) // 16 * 16)
    else:
        half = [int(h) for h in lattice.half]
        per_column = half[0] * n_y * half[1] * n_z * half[2]
        columns = max(1, 16 // half[0], SAMPLES_AT_A_TIME // per_column)
    return [(begin, min(begin + columns, n_x)) for begin in range(0, n_x, columns)]


def sums_by_chunk(
    field: WindingField, lattice: Lattice, tally: Tally, progress: Progress | None = None
) -> Iterator[FloatArray]:
    """Yield the sums over half-blocks, chunk by chunk along x.

    Parameters
    ----------
    field
        The winding number.
    lattice
        The samples.
    tally
        Takes account of all sums.
    progress
        Called with (samples done, samples in all).

    Yields
    ------
    sums
        Shape (end - begin, n_y, n_z) for each range of `chunks_of`.
    """
    per_column = int(np.prod(lattice.n_blocks[1:] * lattice.half[1:]) * lattice.half[0])
    for begin, end in chunks_of(lattice, "average"):
        sums = field.sums(lattice, begin, end)
        tally.add(sums)
        yield sums
        if progress is not None:
            progress(end * per_column, int(lattice.n_blocks[0]) * per_column)


def clipped_by_chunk(
    field: WindingField,
    lattice: Lattice,
    sign: int,
    domain: Domain,
    progress: Progress | None = None,
) -> Iterator[FloatArray]:
    """Yield sums over half-blocks of the samples of the domain, each clipped to [0, 1].

    Parameters
    ----------
    field, lattice
        See `sums_by_chunk`.
    sign
        See `Tally.sign`.
    domain
        Which side of the geometry counts.
    progress
        See `sums_by_chunk`.

    Yields
    ------
    sums
        Shape (end - begin, n_y, n_z) for each range of `chunks_of`.
    """
    per_column = int(np.prod(lattice.n_blocks[1:] * lattice.half[1:]) * lattice.half[0])
    for begin, end in chunks_of(lattice, "clamped"):
        yield clipped_sums(field, lattice, sign, domain, (begin, end))
        if progress is not None:
            progress(end * per_column, int(lattice.n_blocks[0]) * per_column)


def clipped_sums(
    field: WindingField, lattice: Lattice, sign: int, domain: Domain, chunk: tuple[int, int]
) -> FloatArray:
    """Return the sums that `clipped_by_chunk` yields for one chunk.

    Parameters
    ----------
    field, lattice, sign, domain
        See `clipped_by_chunk`.
    chunk
        Range of half-blocks along x.
    """
    single, half = lattice.of_samples(), lattice.half
    counts = single.coverage()
    samples = slice(chunk[0] * int(half[0]), chunk[1] * int(half[0]))
    values = sign * field.sums(single, samples.start, samples.stop)
    if domain == "outside":
        values = 1.0 - values
    np.clip(values, 0.0, 1.0, out=values)
    values *= counts[0][samples, None, None] * counts[1][:, None] * counts[2]
    blocked = [m for n, h in zip(values.shape, half, strict=True) for m in (n // h, h)]
    return np.asarray(values.reshape(blocked).sum(axis=(1, 3, 5)))
