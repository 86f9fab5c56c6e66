"""Measure the local thickness of the material by rays from a sample of its surface.

A ray tracks the winding number, which changes by one at every facet, so overlapping parts count as
one wall and facets inside the material do not count as surface.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from tusqh.geometry.kinds import Geometry
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup import Soup
from tusqh.grid import FloatArray, IntArray
from tusqh.sampling.lattice import Box

#: Number of rays, largest number of pairs of a ray and a facet, and smallest useful number of rays.
_RAYS, _PAIRS, _FEWEST = 256, 100_000_000, 32

#: A hit nearer than this fraction of the extent is at the start of the ray.
_NEAR = 1e-9


@dataclass(frozen=True)
class Thickness:
    """The thickness of the material behind random points of its surface.

    Parameters
    ----------
    lengths
        Distance along the normal to the other side, in model units, shape (n,); infinite if there
        is no other side.
    surface
        Area (2D: length) of that surface, in model units.
    """

    lengths: FloatArray
    surface: float

    def share_below(self, size: float) -> float:
        """Return the share of the surface whose thickness is below a length.

        Parameters
        ----------
        size
            The length, in model units.
        """
        return float((self.lengths < size).mean())

    def material_below(self, size: float) -> float:
        """Return the volume (2D: area) of the walls thinner than a length.

        Each of the two sides of a wall bounds half of it.

        Parameters
        ----------
        size
            The length, in model units.
        """
        thin = np.where(self.lengths < size, self.lengths, 0.0)
        return float(thin.mean()) / 2 * self.surface

    @property
    def resolving(self) -> float:
        """The cell size that puts two cells across all but the thinnest 5 % of the surface."""
        return float(np.quantile(self.lengths, 0.05)) / 2


def measure_thickness(
    geometry: Geometry, *, is_outside: bool = False, window: Box | None = None, seed: int = 0
) -> Thickness | None:
    """Return the thickness of the material at random points of an outline or a soup.

    Parameters
    ----------
    geometry
        The geometry, whose facets point outwards.
    is_outside
        Whether the material lies outside the geometry.
    window
        Box beyond which the surface does not count, in model units.
    seed
        Seed of the random points.

    Returns
    -------
    thickness
        None for images, if too few points are on the surface of the material, or if there are too
        many facets to try.

    Examples
    --------
    >>> plate = np.array([[0.0, 0], [10, 0], [10, 1], [0, 1], [0, 0]])
    >>> thickness = measure_thickness(Outline.from_chains([plate]))
    >>> bool(thickness.share_below(1.1) > 0.8), round(thickness.resolving, 9)
    (True, 0.5)
    """
    if isinstance(geometry, Outline):
        corners = np.asarray(geometry.points[geometry.segments])
        along = corners[:, 1] - corners[:, 0]
        normals = np.stack([along[:, 1], -along[:, 0]], axis=1)
    elif isinstance(geometry, Soup):
        corners = np.asarray(geometry.points[geometry.triangles])
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    else:
        return None
    sizes = np.linalg.norm(normals, axis=1)
    n_rays = min(_RAYS, _PAIRS // len(corners))
    if n_rays < _FEWEST or not 0 < sizes.sum() < np.inf:
        return None
    rng = np.random.default_rng(seed)
    chosen = rng.choice(len(corners), n_rays, p=sizes / sizes.sum())
    weights = rng.dirichlet(np.ones(corners.shape[1]), n_rays)
    starts = np.einsum("rc,rcd->rd", weights, corners[chosen])
    inwards = -normals[chosen] / sizes[chosen, None]
    near = _NEAR * float(np.ptp(corners.reshape(-1, corners.shape[2]), axis=0).max())
    hit = _hit_segments if isinstance(geometry, Outline) else _hit_triangles
    lengths = [
        _follow(*hit(start, inward, corners, facet), near, is_outside=is_outside)
        for start, inward, facet in zip(starts, inwards, chosen.tolist(), strict=True)
        if window is None or ((start >= window[0]) & (start <= window[1])).all()
    ]
    found = np.array([length for length in lengths if length is not None])
    if len(found) < _FEWEST:
        return None
    area = sizes.sum() / (corners.shape[2] - 1)  # Cross products are twice the area.
    return Thickness(found, float(area) * len(found) / n_rays)


def _follow(
    distances: FloatArray, signs: IntArray, near: float, *, is_outside: bool
) -> float | None:
    """Return the length of the material from a facet on, None if the facet is not its surface.

    The ray enters the geometry at its own facet and leaves it at other facets with the sign 1.
    """
    before = -int(signs[distances < -near].sum())
    after = before + 1 - int(signs[np.abs(distances) <= near].sum())
    is_material = [(winding >= 1) != is_outside for winding in (before, after)]
    if is_material[0] == is_material[1]:
        return None
    forwards = 1 if is_material[1] else -1
    ahead = forwards * distances > near
    order = np.argsort(np.abs(distances[ahead]))
    lengths = np.abs(distances[ahead])[order]
    windings = (after if forwards > 0 else before) - np.cumsum(forwards * signs[ahead][order])
    is_last = np.append(np.diff(lengths) > near, True)[: len(lengths)]
    ends = is_last & ((windings >= 1) == is_outside)
    return float(lengths[ends][0]) if ends.any() else np.inf


def _hit_segments(
    start: FloatArray, direction: FloatArray, corners: FloatArray, own: int
) -> tuple[FloatArray, IntArray]:
    """Return the distances at which a ray's line meets segments; it leaves (1) or enters (-1)."""
    along = corners[:, 1] - corners[:, 0]
    away = corners[:, 0] - start
    across = direction[0] * along[:, 1] - direction[1] * along[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = (away[:, 0] * along[:, 1] - away[:, 1] * along[:, 0]) / across
        place = (away[:, 0] * direction[1] - away[:, 1] * direction[0]) / across
        is_hit = (place >= 0) & (place < 1)
    is_hit[own] = False
    return distance[is_hit], np.sign(across[is_hit]).astype(np.int64)


@numba.njit(cache=True)
def _hit_triangles(
    start: FloatArray, direction: FloatArray, corners: FloatArray, own: int
) -> tuple[FloatArray, IntArray]:
    """Return distances and signs of a ray's hits with triangles (Moeller and Trumbore, 1997)."""
    distances, signs = [0.0 for _ in range(0)], [0 for _ in range(0)]
    for m in range(len(corners)):
        a, b, c = corners[m]
        u0, u1, u2 = b[0] - a[0], b[1] - a[1], b[2] - a[2]
        v0, v1, v2 = c[0] - a[0], c[1] - a[1], c[2] - a[2]
        p0 = direction[1] * v2 - direction[2] * v1
        p1 = direction[2] * v0 - direction[0] * v2
        p2 = direction[0] * v1 - direction[1] * v0
        size = u0 * p0 + u1 * p1 + u2 * p2
        if size == 0.0 or m == own:
            continue
        s0, s1, s2 = start[0] - a[0], start[1] - a[1], start[2] - a[2]
        u = (s0 * p0 + s1 * p1 + s2 * p2) / size
        if u < 0 or u > 1:
            continue
        q0, q1, q2 = s1 * u2 - s2 * u1, s2 * u0 - s0 * u2, s0 * u1 - s1 * u0
        v = (direction[0] * q0 + direction[1] * q1 + direction[2] * q2) / size
        if v < 0 or u + v > 1:
            continue
        distances.append((v0 * q0 + v1 * q1 + v2 * q2) / size)
        signs.append(-1 if size > 0 else 1)
    return np.array(distances), np.array(signs, dtype=np.int64)
