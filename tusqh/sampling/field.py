"""Winding numbers of a geometry, summed over the half-blocks of a lattice: one interface.

``crossings`` counts crossings and adds a small cap, exactly or within a tolerance.  ``libigl``
calls libigl at every sample: its tree for soups, which is accurate to two or three digits (Barill
et al., 2018), and its exact sum for outlines.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from tusqh.errors import SamplingError
from tusqh.geometry.kinds import Surface
from tusqh.geometry.outline import Outline
from tusqh.grid import FloatArray
from tusqh.sampling.cap_field import add_cap
from tusqh.sampling.closing import Chain, close
from tusqh.sampling.crossings import add_crossings, correct_sides
from tusqh.sampling.lattice import Lattice
from tusqh.settings.sampling import Sampler, Sampling

#: Default for the largest error of a fraction, dimensionless: the error of rounding to 2^-20.
TOLERANCE = Sampling().tolerance
_FINEST, _COARSEST = 1e-12, 0.01


class WindingField(Protocol):
    """The winding number of a geometry on a lattice."""

    def sums(self, lattice: Lattice, begin: int, end: int) -> FloatArray:
        """Return sums over the samples of the half-blocks ``begin <= i < end`` along x.

        Shape (end - begin, n_y, n_z); samples that do not count add nothing.

        Parameters
        ----------
        lattice
            The samples.
        begin, end
            Range of half-blocks along x.
        """


def wind_on_lattice(field: WindingField, lattice: Lattice) -> FloatArray:
    """Return the winding number at every sample of a lattice, in the shape of the lattice.

    Parameters
    ----------
    field
        The winding number of a geometry.
    lattice
        The samples.

    Examples
    --------
    A tetrahedron without its base is open: inside, its winding number is less than one.

    >>> from tusqh.geometry.soup import Soup
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> faces = np.array([[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 1]])
    >>> zero, ones = np.zeros(3, dtype=np.int64), np.ones(3, dtype=np.int64)
    >>> lattice = Lattice(np.full(3, 0.2), 2.0, ones, 2 * ones, zero, 2 * ones)
    >>> closed = make_field(Soup(points, faces, np.zeros(4, dtype=np.int64)))
    >>> wind_on_lattice(closed, lattice)[0, 0].tolist()
    [1.0, 0.0]
    >>> opened = make_field(Soup(points, faces[:3], np.zeros(3, dtype=np.int64)))
    >>> round(float(wind_on_lattice(opened, lattice)[0, 0, 0]), 2)
    0.76
    """
    single = lattice.of_samples()
    return field.sums(single, 0, int(single.n_blocks[0]))


def make_field(
    geometry: Surface, sampler: Sampler = "crossings", *, tolerance: float = TOLERANCE
) -> WindingField:
    """Return the winding field of a geometry for the chosen sampler.

    Parameters
    ----------
    geometry
        The geometry.
    sampler
        ``"crossings"`` or ``"libigl"``.
    tolerance
        Largest error of a mean over a cell, dimensionless; ``"libigl"`` ignores it.

    Raises
    ------
    SamplingError
        The tolerance is below 1e-12 (the limit of rounding) or above 0.01 (that of the method).
    """
    if not _FINEST <= tolerance <= _COARSEST:
        raise SamplingError(
            f"a tolerance of {tolerance:g}",
            where="tolerance",
            expected=f"a number from {_FINEST:g} to {_COARSEST:g}",
            remedy="leave it out: 1e-6 is the rounding of fractions",
        )
    if sampler == "libigl":
        return LibiglField(geometry)
    return CrossingField(*close(geometry), tolerance)


@dataclass(frozen=True)
class CrossingField:
    """A winding field that adds the crossings of a closed cycle and the winding number of a cap.

    Parameters
    ----------
    cycle, cap
        Two chains whose sum is the geometry, with coordinates in model units.
    tolerance
        Largest error of a mean over a cell, dimensionless.
    """

    cycle: Chain
    cap: Chain
    tolerance: float

    def sums(self, lattice: Lattice, begin: int, end: int) -> FloatArray:
        """Return sums over half-blocks, see `WindingField`.

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
        sums = np.zeros((end - begin, *lattice.n_blocks[1:]))
        add_crossings(_in_steps(self.cycle, lattice), lattice, begin, end, sums)
        cap = _in_steps(self.cap, lattice)
        add_cap(cap, lattice, begin, end, sums, tolerance=self.tolerance)
        correct_sides(cap, lattice, begin, end, sums)
        return sums


@dataclass(frozen=True)
class LibiglField:
    """A winding field that libigl computes at every sample.

    Parameters
    ----------
    geometry
        The geometry.
    """

    geometry: Surface

    def sums(self, lattice: Lattice, begin: int, end: int) -> FloatArray:
        """Return sums over half-blocks, see `WindingField`.

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
        import igl

        half, axes = lattice.half, [lattice.places(k) for k in range(3)]
        axes[0] = axes[0][begin * half[0] : end * half[0]]
        queries = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        # Subtract the origin first, because far from it later differences lose digits.
        queries = queries - lattice.origin
        if isinstance(self.geometry, Outline):
            points = self.geometry.points - lattice.origin[[0, 2]]
            plane = np.ascontiguousarray(queries[:, [0, 2]])
            winding = igl.winding_number(points, self.geometry.segments, plane)
        else:
            points = self.geometry.points - lattice.origin
            winding = igl.fast_winding_number(points, self.geometry.triangles, queries)
        winding = np.asarray(winding).reshape([len(axis) for axis in axes])
        for k, (first, last) in enumerate(zip(lattice.first, lattice.last, strict=True)):
            sample = np.arange(winding.shape[k]) + (begin * half[0] if k == 0 else 0)
            winding[(slice(None),) * k + ((sample < first) | (sample >= last),)] = 0.0
        blocked = [m for n, h in zip(winding.shape, half, strict=True) for m in (n // h, h)]
        return np.asarray(winding.reshape(blocked).sum(axis=(1, 3, 5)))


def _in_steps(chain: Chain, lattice: Lattice) -> Chain:
    """Return a chain with coordinates in steps of the lattice from its first sample."""
    return Chain((chain.corners - lattice.origin) / lattice.step, chain.multiplicity)
