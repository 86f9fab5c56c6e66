"""The image: voxels in space or pixels in the plane, each with a volume fraction of material."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tusqh.errors import GeometryError
from tusqh.grid import FloatArray

__all__ = ["Image"]


@dataclass(frozen=True)
class Image:
    """Cubic voxels, or square pixels, of constant volume fraction, as measured, without filtering.

    Parameters
    ----------
    voxels
        Grey values, shape (nx, ny, nz) or (nx, ny), any real dtype, indexed ``[i, j, k]`` =
        (x, y, z).
    voxel_size
        Edge length of a voxel, in the units of the model.
    empty, full
        Grey values of fraction 0 and of fraction 1; fractions are linear between them and clipped
        beyond them.
        ``empty > full`` makes dark voxels the material.
    origin
        Lowest corner of the first voxel, in the units of the model; empty: 0.
    name
        Where it came from, for messages.
    unit
        Unit of length of the voxel size and the origin; empty if it is not known.

    Raises
    ------
    GeometryError
        The array does not have two or three axes, or has no voxels; a value is not a finite real
        number; the voxel size is not positive; or `empty` and `full` are equal.

    Examples
    --------
    >>> image = Image(np.array([[[0, 50, 200]]], dtype=np.uint8), 0.5, empty=0, full=100)
    >>> image.fractions().tolist(), image.bounding_box()
    ([[[0.0, 0.5, 1.0]]], ((0.0, 0.0, 0.0), (0.5, 0.5, 1.5)))
    >>> Image(np.ones((4, 3))).bounding_box()
    ((0.0, 0.0), (4.0, 3.0))
    """

    voxels: NDArray[Any]
    voxel_size: float = 1.0
    empty: float = 0.0
    full: float = 1.0
    origin: tuple[float, ...] = ()
    name: str = "image"
    unit: str = ""

    def __post_init__(self) -> None:
        if self.voxels.ndim not in (2, 3) or self.voxels.size == 0:
            raise _wrong(
                f"the image has shape {self.voxels.shape}",
                name=self.name,
                expected="two or three axes (x, y, z) with at least one voxel each",
                remedy="give a grey picture, or a stack of grey slices, without colours",
            )
        if not self.origin:
            object.__setattr__(self, "origin", (0.0,) * self.voxels.ndim)
        if self.voxels.dtype.kind not in "buif" or not np.isfinite(self.voxels).all():
            raise _wrong(
                f"voxels of type {self.voxels.dtype} are not all finite real numbers",
                name=self.name,
                expected="grey values",
                remedy="replace NaN and infinite voxels by finite values",
            )
        if not (np.isfinite(self.voxel_size) and self.voxel_size > 0):
            raise _wrong(
                f"the voxel size is {self.voxel_size}",
                name=self.name,
                expected="a positive length",
                remedy="give `voxel_size` in the units of the model",
            )
        if not (np.isfinite([self.empty, self.full]).all() and self.empty != self.full):
            raise _wrong(
                f"`empty` is {self.empty} and `full` is {self.full}",
                name=self.name,
                expected="two different grey values",
                remedy="give the grey values of voxels without material and full of material",
            )

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of voxels along each axis."""
        return self.voxels.shape

    @property
    def dim(self) -> int:
        """Number of axes: 2 for a picture, which is a model in the plane, 3 for an image."""
        return self.voxels.ndim

    def bounding_box(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Return the lowest and the highest corner of the image.

        Returns
        -------
        low, high : tuple of float
            Coordinates of the corners.
        """
        upper = np.add(self.origin, np.multiply(self.shape, self.voxel_size))
        return tuple(float(x) for x in self.origin), tuple(upper.tolist())

    def fractions(self, part: Any = ...) -> FloatArray:
        """Return the volume fractions of the voxels, in [0, 1].

        Parameters
        ----------
        part
            An index into `voxels`, to get the fractions of some of them.
        """
        values = self.voxels[part].astype(np.float64)
        return np.asarray(np.clip((values - self.empty) / (self.full - self.empty), 0.0, 1.0))

    @classmethod
    def from_voxels(
        cls,
        voxels: NDArray[Any],
        *,
        voxel_size: float = 1.0,
        empty: float | None = None,
        full: float | None = None,
        origin: Sequence[float] = (),
        name: str = "image",
    ) -> Image:
        """Return the image of grey values; their type gives the defaults of `empty` and `full`.

        Booleans and floats are fractions already.  For integers, 0 is empty and the largest value
        in the image is full.

        Parameters
        ----------
        voxels
            Grey values, shape (nx, ny, nz) or (nx, ny).
        voxel_size
            Edge length of a voxel, in the units of the model.
        empty, full
            Grey values of fraction 0 and 1; None for the defaults.
        origin
            Lowest corner of the first voxel, in the units of the model; empty: 0.
        name
            Where it came from, for messages.

        Raises
        ------
        GeometryError
            See `Image`; or there are floats outside [0, 1] and neither `empty` nor `full` is given.

        Examples
        --------
        >>> Image.from_voxels(np.array([[[0, 255]]], dtype=np.uint8)).full
        255.0
        """
        is_known = empty is not None or full is not None
        greatest = 1.0
        if voxels.dtype.kind in "ui" and voxels.size:
            greatest = float(max(voxels.max(), 1))
        image = cls(
            voxels=voxels,
            voxel_size=float(voxel_size),
            empty=0.0 if empty is None else float(empty),
            full=greatest if full is None else float(full),
            origin=tuple(map(float, origin)),
            name=name,
        )
        if not is_known and (voxels.min() < 0 or voxels.max() > greatest):
            raise _wrong(
                f"the grey values go from {voxels.min():g} to {voxels.max():g}",
                name=name,
                expected="fractions between 0 and 1, or `empty` and `full`",
                remedy="give the grey values of fraction 0 (`empty`) and of fraction 1 (`full`)",
            )
        return image


def _wrong(found: str, *, name: str, expected: str, remedy: str) -> GeometryError:
    """Return the error for arrays and numbers that are not an image."""
    return GeometryError(found, where=name, expected=expected, remedy=remedy)
