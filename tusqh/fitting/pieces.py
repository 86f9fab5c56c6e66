"""Cut facets into pieces of at most half a cell, and pick few samples that represent them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tusqh.grid import FloatArray, IntArray

#: Longest edge of a piece, in cells.
SIZE = 0.5
#: Sizes of the boxes of which each gives one sample: of position in cells, and of normals.
_BOX, _BOX_OF_NORMALS = 0.25, 0.5
#: Pieces this far outside the grid do not count, in cells.
_OUTSIDE = 0.05
#: Smallest area of a piece whose normal means something, in cells squared.
_LEAST = 1e-14


class Samples(NamedTuple):
    """Samples of pieces.

    Parameters
    ----------
    points, normals
        Centre and normal of the first piece of every sample, shape (s, 3) each.
    sample
        The sample of each piece, shape (p,).
    areas
        Area of each piece, shape (p,).
    """

    points: FloatArray
    normals: FloatArray
    sample: IntArray
    areas: FloatArray


def cut_pieces(corners: FloatArray, upper: FloatArray) -> FloatArray:
    """Return the pieces of triangles in a grid, no edge longer than `SIZE`, shape (p, 3, 3).

    The longest edge is halved until it is short enough.  Pieces outside the grid and pieces without
    an area are left out.

    Parameters
    ----------
    corners
        Corners of every triangle, in cells from the origin of the grid, shape (m, 3, 3).
    upper
        Number of cells along each axis, shape (3,).
    """
    done = []
    while len(corners):
        is_near = (corners.max(axis=1) >= -_OUTSIDE).all(axis=1)
        is_near &= (corners.min(axis=1) <= upper + _OUTSIDE).all(axis=1)
        corners = corners[is_near]
        lengths = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
        longest = lengths.argmax(axis=1)
        is_long = lengths.max(axis=1, initial=0.0) > SIZE
        done.append(corners[~is_long])
        corners, longest = corners[is_long], longest[is_long]
        row = np.arange(len(corners))
        a, b, c = (corners[row, (longest + k) % 3] for k in range(3))
        middle = (a + b) / 2
        halves = np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)
        corners = np.concatenate(halves)
    pieces = np.concatenate(done) if done else corners
    centre = pieces.mean(axis=1)
    is_in = ((centre >= -_OUTSIDE) & (centre <= upper + _OUTSIDE)).all(axis=1)
    return np.asarray(pieces[is_in & (sizes_of(pieces) > _LEAST)])


def pick_samples(pieces: FloatArray) -> Samples:
    """Return one sample for each small box of positions and normals.

    Parameters
    ----------
    pieces
        Corners of the pieces, shape (p, 3, 3).
    """
    centre = pieces.mean(axis=1)
    normal = normals_of(pieces)
    place = np.rint(np.concatenate([centre / _BOX, normal / _BOX_OF_NORMALS], axis=1))
    place = place.astype(np.int64)
    place -= place.min(axis=0, initial=0)
    key = np.zeros(len(pieces), dtype=np.int64)
    for column in place.T:
        key = key * (int(column.max(initial=0)) + 1) + column
    _, first, sample = np.unique(key, return_index=True, return_inverse=True)
    return Samples(centre[first], normal[first], sample.ravel(), sizes_of(pieces))


def normals_of(pieces: FloatArray) -> FloatArray:
    """Return the unit normals of pieces, shape (p, dim).

    Parameters
    ----------
    pieces
        Corners of the pieces; normals of segments are on their right, shape (p, dim, dim).
    """
    across = _across(pieces)
    return np.asarray(across / np.maximum(np.linalg.norm(across, axis=1), 1e-300)[:, None])


def sizes_of(pieces: FloatArray) -> FloatArray:
    """Return the area of triangles, or the length of segments, shape (p,).

    Parameters
    ----------
    pieces
        Corners of the pieces, shape (p, dim, dim).
    """
    return np.asarray(np.linalg.norm(_across(pieces), axis=1) / (pieces.shape[1] - 1))


def in_space(vectors: FloatArray) -> FloatArray:
    """Return points or vectors with three coordinates; those in the plane get a zero.

    Parameters
    ----------
    vectors
        The points or vectors, shape (..., dim).
    """
    if vectors.shape[-1] == 3:
        return vectors
    return np.concatenate([vectors, np.zeros((*vectors.shape[:-1], 1))], axis=-1)


def _across(pieces: FloatArray) -> FloatArray:
    """Return vectors across pieces, with their length or twice their area."""
    along = pieces[:, 1] - pieces[:, 0]
    if pieces.shape[1] == 3:
        return np.cross(along, pieces[:, 2] - pieces[:, 0])
    return np.stack([along[:, 1], -along[:, 0]], axis=1)
