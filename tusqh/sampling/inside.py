"""What is inside a geometry: fields that are 1 inside and 0 outside, made without its directions.

A winding number tells inside from outside by the directions of the surface, so it is 0 around
doubled sheets and blurred around open ones.  The envelope and the shell depend on distances only.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numba
import numpy as np

from tusqh.geometry.kinds import Surface
from tusqh.grid import FloatArray, IntArray
from tusqh.sampling.envelope import Envelope, corners_of, make_envelope
from tusqh.sampling.field import WindingField, make_field
from tusqh.sampling.flood import COVERED, REACHED
from tusqh.sampling.inside_lengths import seal_of, thickness_of
from tusqh.sampling.lattice import Lattice
from tusqh.sampling.offset_scan import Marks, mark_near
from tusqh.settings.sampling import Orientation, Sampling

#: Least number of steps of the lattice in the diameter of the ball.
_STEPS = 2.0
#: Largest difference of two samples that are the same, in steps.
_SAME = 1e-6
#: Least winding number in a solid, up to rounding.
_HALF = 0.5 - 1e-9
#: Samples of a winding number that are summed at a time to find its sign.
_AT_A_TIME = 8_000_000


def field_of(geometry: Surface, sampling: Sampling, cell_size: float) -> WindingField:
    """Return the field whose means are the volume fractions of a geometry.

    Parameters
    ----------
    geometry
        The geometry, its parts turned.
    sampling
        What is inside, and how winding numbers are sampled.
    cell_size
        Edge length of a cell, in model units.

    Raises
    ------
    SamplingError
        The thickness or the seal does not fit the cells or the geometry.
    """
    if sampling.inside == "envelope":
        return EnvelopeField(geometry, seal_of(geometry, sampling, cell_size))
    winding: Callable[[], WindingField] = lambda: make_field(  # noqa: E731
        geometry, sampling.sampler, tolerance=sampling.tolerance
    )
    if sampling.inside == "winding":
        return winding()
    shell = ShellField(corners_of(geometry), thickness_of(geometry, sampling, cell_size) / 2)
    if sampling.inside == "shell":
        return shell
    return UnionField(winding(), shell, sampling.orientation)


@dataclass(frozen=True)
class ShellField:
    """The points nearer to the geometry than a radius.

    Parameters
    ----------
    corners
        Triangles, shape (m, 3, 3), or segments in the plane y = 0, shape (m, 2, 3), in model units.
    radius
        The radius, in model units.
    """

    corners: FloatArray
    radius: float

    def sums(self, lattice: Lattice, begin: int, end: int) -> FloatArray:
        """Return sums over half-blocks, see `tusqh.sampling.field.WindingField`.

        Parameters
        ----------
        lattice
            The samples.
        begin, end
            Range of half-blocks along x.

        Returns
        -------
        sums
            Shape (end - begin, n_y, n_z), dimensionless.
        """
        first = begin * int(lattice.half[0])
        shape = ((end - begin) * int(lattice.half[0]), *(lattice.n_blocks * lattice.half)[1:])
        marks: Marks = np.zeros(shape, dtype=np.uint8)
        corners = (self.corners - lattice.origin) / lattice.step - [first, 0, 0]
        mark_near(corners, self.radius / lattice.step, 1, marks)
        offset = np.array([-first, 0, 0])
        return _sum_marks(marks, offset, 1, (1, 1), lattice, begin, end)


@dataclass(frozen=True)
class EnvelopeField:
    """What a ball cannot reach from outside.

    Parameters
    ----------
    geometry
        The geometry.
    seal
        Diameter of the ball, in model units.
    """

    geometry: Surface
    seal: float
    _made: list[Envelope] = field(default_factory=list, repr=False, compare=False)

    def sums(self, lattice: Lattice, begin: int, end: int) -> FloatArray:
        """Return sums over half-blocks, see `tusqh.sampling.field.WindingField`.

        Parameters
        ----------
        lattice
            The samples.
        begin, end
            Range of half-blocks along x.

        Returns
        -------
        sums
            Shape (end - begin, n_y, n_z), dimensionless.
        """
        envelope = self.on(lattice)
        offset = np.rint((lattice.origin - envelope.origin) / envelope.step).astype(np.int64)
        stride = round(lattice.step / envelope.step)
        outside = REACHED | COVERED
        return _sum_marks(envelope.marks, offset, stride, (outside, 0), lattice, begin, end)

    def on(self, lattice: Lattice) -> Envelope:
        """Return the envelope on the samples of a lattice, and on those between them if needed.

        Parameters
        ----------
        lattice
            The samples.  Lattices that are moved by whole samples share an envelope.
        """
        # An odd number, so that the samples of the lattice are among those of the envelope.
        parts = 2 * int(np.ceil((_STEPS * lattice.step / self.seal * (1 - 1e-9) - 1) / 2)) + 1
        step = lattice.step / max(parts, 1)
        for envelope in self._made:
            apart = (lattice.origin - envelope.origin) / step
            is_same = abs(envelope.step / step - 1) < _SAME / max(envelope.marks.shape)
            if is_same and np.abs(apart - np.rint(apart)).max() < _SAME:
                return envelope
        self._made.clear()
        self._made.append(make_envelope(self.geometry, self.seal, origin=lattice.origin, step=step))
        return self._made[0]


@dataclass(frozen=True)
class UnionField:
    """The points with a winding number of at least 1/2, and those near the geometry.

    Parameters
    ----------
    winding
        The winding number.
    shell
        The shell.
    orientation
        Whether the winding number is negated, see `tusqh.settings.sampling.Sampling`.
    """

    winding: WindingField
    shell: ShellField
    orientation: Orientation
    _sign: list[int] = field(default_factory=list, repr=False, compare=False)

    def sums(self, lattice: Lattice, begin: int, end: int) -> FloatArray:
        """Return sums over half-blocks, see `tusqh.sampling.field.WindingField`.

        Parameters
        ----------
        lattice
            The samples.
        begin, end
            Range of half-blocks along x.

        Returns
        -------
        sums
            Shape (end - begin, n_y, n_z), dimensionless.
        """
        single, half = lattice.of_samples(), lattice.half
        first, last = begin * int(half[0]), end * int(half[0])
        is_solid = self.sign(lattice) * self.winding.sums(single, first, last) >= _HALF
        values = np.maximum(is_solid, self.shell.sums(single, first, last))
        blocked = [m for n, h in zip(values.shape, half, strict=True) for m in (n // h, h)]
        return np.asarray(values.reshape(blocked).sum(axis=(1, 3, 5)))

    def sign(self, lattice: Lattice) -> int:
        """Return -1 if the winding number must be negated, otherwise 1.

        Parameters
        ----------
        lattice
            The samples, of which more have at least 1/2 than at most -1/2 afterwards.
        """
        if self.orientation != "auto":
            return -1 if self.orientation == "flip" else 1
        if not self._sign:
            single = lattice.of_samples()
            n, per = int(single.n_blocks[0]), int(single.n_blocks[1] * single.n_blocks[2])
            rows = max(16, _AT_A_TIME // per // 16 * 16)
            surplus = 0
            for k in range(0, n, rows):
                values = self.winding.sums(single, k, min(k + rows, n))
                surplus += int((values >= _HALF).sum()) - int((values <= -_HALF).sum())
            self._sign.append(-1 if surplus < 0 else 1)
        return self._sign[0]


def without_directions(sampling: Sampling) -> Sampling:
    """Return the sampling of a field that is made: what it gives is not negated.

    Parameters
    ----------
    sampling
        How a geometry is sampled.
    """
    return sampling if sampling.inside == "winding" else replace(sampling, orientation="as-is")


def _sum_marks(
    marks: Marks,
    offset: IntArray,
    stride: int,
    sought: tuple[int, int],
    lattice: Lattice,
    begin: int,
    end: int,
) -> FloatArray:
    """Return the numbers of samples in half-blocks whose marks, masked, have a value."""
    sums = np.zeros((end - begin, *lattice.n_blocks[1:]))
    _add_marks(
        marks, offset, stride, *sought, lattice.half, lattice.first, lattice.last, begin, sums
    )
    return sums


@numba.njit(cache=True, parallel=True)
def _add_marks(  # type: ignore[no-untyped-def]
    marks, offset, stride, mask, value, half, first, last, begin, sums
):
    """Count samples, of which number k of the lattice is ``marks[offset + stride * k]``, if any."""
    for row in numba.prange(sums.shape[0]):
        for i in range((row + begin) * half[0], (row + begin + 1) * half[0]):
            x = offset[0] + stride * i
            if x < 0 or x >= marks.shape[0] or i < first[0] or i >= last[0]:
                continue
            for j in range(first[1], last[1]):
                y = offset[1] + stride * j
                if y < 0 or y >= marks.shape[1]:
                    continue
                for k in range(first[2], last[2]):
                    z = offset[2] + stride * k
                    if 0 <= z < marks.shape[2] and marks[x, y, z] & mask == value:
                        sums[row, j // half[1], k // half[2]] += 1.0
