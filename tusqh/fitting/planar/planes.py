"""The lines that attract the boundary points: those of patches, of samples, of the level set."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.ndimage import map_coordinates
from scipy.spatial import cKDTree

from tusqh.fitting.planar.patches import Patches
from tusqh.fitting.target import Target
from tusqh.grid import BoolArray, FloatArray, IntArray

#: Weight of normals against positions in the search for the nearest sample.
_NORMALS = 0.7

#: Distance that separates patches in the search, so that only samples of one patch are found.
_APART = 1e3

#: A sample is compatible if the cosine of the angle between the normals is larger than this, and
#: it lies at most this far along its line and off it, in cells.
_FACING, _ALONG, _OFF = 0.2, 0.9, 1.25

#: Smallest slope of the fractions, per cell, at which their level set is followed.
_SLOPE = 0.2


class Lines(NamedTuple):
    """A line for every asked place.

    Parameters
    ----------
    foot
        The nearest point of the line, shape (n, 2).
    normal
        The unit normal, out of the material, shape (n, 2).
    holds
        Whether there is a line, shape (n,).
    """

    foot: FloatArray
    normal: FloatArray
    holds: BoolArray


class Attraction:
    """Nearest lines of a target.

    Parameters
    ----------
    target
        The target.
    patches
        The patches of its samples.
    """

    def __init__(self, target: Target, patches: Patches) -> None:
        self.target, self.patches = target, patches
        features = np.concatenate([target.points, _NORMALS * target.normals], axis=1)
        self._any = cKDTree(features) if len(features) else None
        patch = _APART * patches.number[:, None]
        self._one = cKDTree(np.concatenate([features, patch], axis=1)) if len(features) else None

    def lines(self, places: FloatArray, normals: FloatArray, patch: IntArray) -> Lines:
        """Return the nearest compatible line at every place.

        Parameters
        ----------
        places, normals
            Places and outward normals of the mesh there, shape (n, 2) each.
        patch
            The patch whose line is wanted, -1 for any, shape (n,).
        """
        found = self.level_set(places, normals)
        if self._any is None or self._one is None or len(places) == 0:
            return found
        asked = np.concatenate([places, _NORMALS * normals], axis=1)
        rows = np.empty(len(places), dtype=np.int64)
        is_any = patch < 0
        rows[is_any] = self._any.query(asked[is_any])[1]
        within = np.concatenate([asked, _APART * patch[:, None]], axis=1)[~is_any]
        rows[~is_any] = self._one.query(within)[1]
        point, normal = self.target.points[rows], self.target.normals[rows]
        off = ((places - point) * normal).sum(axis=1)
        foot = places - off[:, None] * normal
        along = np.linalg.norm(foot - point, axis=1)
        holds = ((normal * normals).sum(axis=1) > _FACING) & (np.abs(off) < _OFF)
        # A line of a patch is longer than its samples, so that both sides of a corner meet.
        holds &= np.where(is_any, along < _ALONG, along < 2 * _OFF)
        return Lines(
            np.where(holds[:, None], foot, found.foot),
            np.where(holds[:, None], normal, found.normal),
            holds | found.holds,
        )

    def level_set(self, places: FloatArray, normals: FloatArray) -> Lines:
        """Return the line of the 1/2 level set of the fractions at every place.

        Parameters
        ----------
        places, normals
            See `lines`.
        """
        value = self._fraction(places)
        step = 0.25
        slopes = np.empty_like(places)
        for axis in range(2):
            shift = np.zeros(2)
            shift[axis] = step
            ahead, behind = self._fraction(places + shift), self._fraction(places - shift)
            slopes[:, axis] = (ahead - behind) / (2 * step)
        size = np.linalg.norm(slopes, axis=1)
        normal = -slopes / np.maximum(size, 1e-300)[:, None]
        off = (value - 0.5) / np.maximum(size, 1e-300)
        holds = (size > _SLOPE) & (np.abs(off) < _OFF)
        holds &= (normal * normals).sum(axis=1) > _FACING
        return Lines(places + off[:, None] * normal, normal, holds)

    def _fraction(self, places: FloatArray) -> FloatArray:
        """Return the fractions at places, linear between those of the doubled grid."""
        found = map_coordinates(self.target.level, 2 * places.T, order=1, mode="nearest")
        return np.asarray(found, dtype=np.float64)
