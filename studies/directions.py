"""List orientations of a gap between two half-spaces, up to symmetry."""

from __future__ import annotations

import numpy as np

from tusqh.grid import FloatArray


def normals_of(places: FloatArray) -> FloatArray:
    """Return the unit normals of orientations, shape (m, dim), see `Widths.places`.

    Parameters
    ----------
    places
        Orientations, see `Widths.places`.

    Examples
    --------
    >>> normals_of(np.array([[45.0]])).round(3).tolist()
    [[0.707, 0.707]]
    """
    if places.shape[1] == 1:
        angle = np.deg2rad(places[:, 0])
        return np.stack([np.cos(angle), np.sin(angle)], axis=1)
    normals = np.column_stack([np.ones(len(places)), places])
    return np.asarray(normals / np.linalg.norm(normals, axis=1, keepdims=True))


def rotations(step: float) -> FloatArray:
    """Return rotations from 0 to 45 degrees, which are all rotations up to symmetry, shape (m, 1).

    Parameters
    ----------
    step
        Step in degrees.
    """
    return np.linspace(0.0, 45.0, round(45 / step) + 1)[:, None]


def plane_normals(n: int) -> FloatArray:
    """Return normals over the symmetric patch of the sphere, as ratios, shape (m, 2).

    Parameters
    ----------
    n
        Number of steps along each side of the patch.

    Examples
    --------
    >>> plane_normals(1).tolist()
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]
    """
    return np.array([[a / n, b / n] for a in range(n + 1) for b in range(a + 1)])
