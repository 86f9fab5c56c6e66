"""The directions of the axes of a grid: given angles, dominant faces, or principal axes."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from tusqh.errors import SamplingError
from tusqh.geometry.kinds import Surface
from tusqh.geometry.outline import Outline
from tusqh.grid import FloatArray
from tusqh.settings.grid import Grid

#: Normals with a smaller angle between them are of one direction, as the sine of that angle.
_ONE_DIRECTION = 0.01

#: Least share of the area that faces of a dominant direction have.
_LEAST_SHARE = 0.05

#: Second moments that differ by less, relative to the largest, are equal.
_EQUAL = 1e-6

#: Largest deviation of a rotation matrix from an orthonormal one.
_ORTHONORMAL = 1e-6


def find_directions(surfaces: Sequence[Surface], grid: Grid) -> FloatArray | None:
    """Return the directions of the axes of a grid, shape (dim, dim), one row for each axis.

    Parameters
    ----------
    surfaces
        The geometry.
    grid
        The settings of the grid.

    Returns
    -------
    directions
        Orthonormal and right-handed; None for the axes of the coordinates.

    Raises
    ------
    SamplingError
        `rotate` is not a rotation, or the geometry has no dominant faces or principal axes.
    """
    dim = len(surfaces[0].bounding_box()[0])
    if grid.rotate is not None:
        axes = _rotation(grid.rotate, dim, surfaces[0].name)
    elif grid.align == "faces":
        axes = _by_faces(surfaces, dim)
    elif grid.align == "principal":
        axes = _principal(surfaces, dim)
    else:
        return None
    return None if np.abs(axes - np.eye(dim)).max() < 1e-12 else axes


def _rotation(numbers: Sequence[float], dim: int, name: str) -> FloatArray:
    """Return the axes for angles in degrees, or for a rotation matrix in rows."""
    if len(numbers) == dim**2:
        matrix = np.reshape(numbers, (dim, dim))
        is_rotation = np.abs(matrix @ matrix.T - np.eye(dim)).max() < _ORTHONORMAL
        if not is_rotation or np.linalg.det(matrix) < 0:
            raise SamplingError(
                f"the matrix {matrix.tolist()} is not a rotation"
                + (": it mirrors" if is_rotation else ""),
                where=f"{name}, `grid.rotate`",
                expected="rows of length 1, perpendicular to each other, with the determinant 1",
                remedy="correct the matrix, or give angles",
            )
        left, _, right = np.linalg.svd(matrix)
        return np.asarray(left @ right)
    if len(numbers) != (1 if dim == 2 else 3):
        raise SamplingError(
            f"`grid.rotate` has {len(numbers)} numbers, the geometry has {dim} dimensions",
            where=name,
            expected="one angle or 4 numbers of a matrix in 2D, three angles or 9 numbers in 3D",
            remedy="give angles in degrees, about x, then y, then z",
        )
    if dim == 2:
        return _about(2, numbers[0])[:2, :2].T
    x, y, z = (_about(axis, angle) for axis, angle in enumerate(numbers))
    return (z @ y @ x).T  # The columns of a rotation are where it takes the axes.


def _about(axis: int, degrees: float) -> FloatArray:
    """Return the matrix of a rotation about an axis of the coordinates."""
    angle = np.deg2rad(degrees)
    matrix = np.eye(3)
    a, b = (axis + 1) % 3, (axis + 2) % 3
    matrix[a, a] = matrix[b, b] = np.cos(angle)
    matrix[b, a] = np.sin(angle)
    matrix[a, b] = -matrix[b, a]
    return matrix


def _by_faces(surfaces: Sequence[Surface], dim: int) -> FloatArray:
    """Return the directions of the most face area that are perpendicular to each other."""
    normals, areas = (np.concatenate(a) for a in zip(*map(_normals, surfaces), strict=True))
    total, axes = areas.sum(), np.empty((0, dim))
    for _ in range(dim - 1):
        is_free = (np.abs(normals @ axes.T) < _ONE_DIRECTION).all(axis=1) & (areas > 0)
        direction, share = _dominant(normals[is_free], areas[is_free])
        if share < _LEAST_SHARE * total:
            if len(axes) == 0:
                raise SamplingError(
                    f"no direction has faces with at least {100 * _LEAST_SHARE:g} % of the area",
                    where=f"{surfaces[0].name}, `align: faces`",
                    expected="plane faces (2D: straight edges)",
                    remedy="use `align: principal`, or `rotate`",
                )
            return _near_coordinates_with(axes[0])
        direction = direction - axes.T @ (axes @ direction)
        axes = np.vstack([axes, direction / np.linalg.norm(direction)])
    last = [-axes[0, 1], axes[0, 0]] if dim == 2 else np.cross(axes[0], axes[1])
    return _near_coordinates(np.vstack([axes, last]))


def _normals(surface: Surface) -> tuple[FloatArray, FloatArray]:
    """Return the unit normals of facets and their areas."""
    if isinstance(surface, Outline):
        a, b = np.moveaxis(surface.points[surface.segments], 1, 0)
        across = np.column_stack([b[:, 1] - a[:, 1], a[:, 0] - b[:, 0]])
    else:
        a, b, c = np.moveaxis(surface.points[surface.triangles], 1, 0)
        across = np.cross(b - a, c - a) / 2
    areas = np.linalg.norm(across, axis=1)
    return across / np.maximum(areas, 1e-300)[:, None], areas


def _dominant(normals: FloatArray, areas: FloatArray) -> tuple[FloatArray, float]:
    """Return the direction with the most area, the opposite one counted, and that area."""
    if len(normals) == 0:
        return np.zeros(normals.shape[1]), 0.0
    keys = np.rint(normals / _ONE_DIRECTION).astype(np.int64)
    first = np.argmax(keys != 0, axis=1)
    keys *= np.sign(np.take_along_axis(keys, first[:, None], axis=1))
    kinds, number = np.unique(keys, axis=0, return_inverse=True)
    by_kind = np.bincount(number.ravel(), weights=areas, minlength=len(kinds))
    found, share = kinds[0] * 1.0, 0.0
    for kind in np.argsort(-by_kind, kind="stable")[:8]:  # Faces may be split between neighbours.
        seed = kinds[kind] / np.linalg.norm(kinds[kind])
        along = normals @ seed
        is_near = 1 - np.abs(along) < _ONE_DIRECTION**2
        area = float(areas[is_near].sum())
        if area > share * (1 + 1e-9):
            mean = (normals * (np.sign(along) * areas)[:, None])[is_near].sum(axis=0)
            found, share = mean / np.linalg.norm(mean), area
    return found, share


def _principal(surfaces: Sequence[Surface], dim: int) -> FloatArray:
    """Return the principal axes of the surface, from its exact second moments."""
    low = np.min([s.bounding_box()[0] for s in surfaces], axis=0)
    total, first, second = 0.0, np.zeros(dim), np.zeros((dim, dim))
    for surface in surfaces:
        facets = surface.segments if isinstance(surface, Outline) else surface.triangles
        corners = surface.points[facets] - low
        areas = _normals(surface)[1]
        # The mean of x x' over a simplex with n corners c and the sum s of them:
        # (sum of c c' + s s') / (n (n + 1)).
        sums, n = corners.sum(axis=1), corners.shape[1]
        squares = np.einsum("m,mki,mkj->ij", areas, corners, corners)
        squares += np.einsum("m,mi,mj->ij", areas, sums, sums)
        total, first = total + areas.sum(), first + areas @ sums / n
        second += squares / (n * (n + 1))
    moments, vectors = np.linalg.eigh(second / total - np.outer(first, first) / total**2)
    is_equal = np.diff(moments) < _EQUAL * moments[-1]
    if is_equal.all():
        raise SamplingError(
            "the second moments of the surface are equal along all axes",
            where=f"{surfaces[0].name}, `align: principal`",
            expected="a longest or a shortest direction",
            remedy="use `align: faces`, or `rotate`",
        )
    if is_equal.any():  # A round or square cross-section: one axis is known.
        return _near_coordinates_with(vectors[:, 2 if is_equal[0] else 0])
    return _near_coordinates(vectors.T)


def _near_coordinates(axes: FloatArray) -> FloatArray:
    """Return directions in the order and with the signs that turn the coordinates the least."""
    dim = len(axes)
    best, trace = axes, -np.inf
    for order in itertools.permutations(range(dim)):
        chosen = axes[list(order)]
        signs = np.where(np.diagonal(chosen) < 0, -1.0, 1.0)
        weakest = int(np.argmin(np.abs(np.diagonal(chosen))))
        if np.linalg.det(chosen * signs[:, None]) < 0:
            signs[weakest] *= -1
        turned = chosen * signs[:, None]
        if np.trace(turned) > trace + 1e-12:
            best, trace = turned, float(np.trace(turned))
    return best


def _near_coordinates_with(axis: FloatArray) -> FloatArray:
    """Return the axes after the smallest rotation that takes an axis of the coordinates to one."""
    k = int(np.argmax(np.abs(axis)))
    axis = axis * np.sign(axis[k])
    start = np.eye(len(axis))[k]
    # The product of the reflections in start + axis and in start, applied to every axis.
    middle = start + axis
    mirror = np.eye(len(axis)) - 2 * np.outer(middle, middle) / (middle @ middle)
    rotation = mirror @ (np.eye(len(axis)) - 2 * np.outer(start, start))
    return np.asarray(rotation.T)
