"""The local thickness of a geometry, by rays from a sample of its surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tusqh.geometry.kinds import Geometry
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup import Soup
from tusqh.grid import FloatArray

#: Rays, and the most pairs of a ray and a facet that are tried.
_RAYS, _PAIRS = 512, 20_000_000

#: A hit nearer than this part of the extent is the facet that the ray starts from.
_NEAR = 1e-9


@dataclass(frozen=True)
class Thickness:
    """The thickness behind random points of a surface.

    Parameters
    ----------
    lengths
        Distance along the inner normal to the surface beyond, in model units, shape (n,).
    """

    lengths: FloatArray

    def share_below(self, size: float) -> float:
        """Return the share of the surface that is nearer to its other side than a length.

        Parameters
        ----------
        size
            The length, in model units.
        """
        return float((self.lengths < size).mean())

    @property
    def resolving(self) -> float:
        """The cell size with at least two cells across all but the thinnest 5 % of the surface."""
        return float(np.quantile(self.lengths, 0.05)) / 2


def measure_thickness(geometry: Geometry, *, seed: int = 0) -> Thickness | None:
    """Return the thickness of an outline or a soup at random points of it.

    A ray goes inwards from each point, to the side that the orientation of its facet says.

    Parameters
    ----------
    geometry
        The geometry.
    seed
        Of the random points.

    Returns
    -------
    thickness
        None for images, for surfaces that no ray hits twice, and for more facets than can be tried.

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
        normals = np.stack([-along[:, 1], along[:, 0]], axis=1)
    elif isinstance(geometry, Soup):
        corners = np.asarray(geometry.points[geometry.triangles])
        normals = -np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    else:
        return None
    sizes = np.linalg.norm(normals, axis=1)
    n_rays = min(_RAYS, _PAIRS // len(corners))
    if n_rays < 16 or not sizes.sum() > 0:
        return None
    rng = np.random.default_rng(seed)
    chosen = rng.choice(len(corners), n_rays, p=sizes / sizes.sum())
    weights = rng.dirichlet(np.ones(corners.shape[1]), n_rays)
    starts = np.einsum("rc,rcd->rd", weights, corners[chosen])
    directions = normals[chosen] / sizes[chosen, None]
    extent = float(np.ptp(corners.reshape(-1, corners.shape[2]), axis=0).max())
    hit = _hit_segments if isinstance(geometry, Outline) else _hit_triangles
    lengths = np.array(
        [
            hit(start, direction, corners, _NEAR * extent)
            for start, direction in zip(starts, directions, strict=True)
        ]
    )
    lengths = lengths[np.isfinite(lengths)]
    return Thickness(lengths) if len(lengths) else None


def _hit_segments(
    start: FloatArray, direction: FloatArray, corners: FloatArray, near: float
) -> float:
    """Return the distance to the nearest segment along a ray, infinite where there is none."""
    along = corners[:, 1] - corners[:, 0]
    away = corners[:, 0] - start
    with np.errstate(divide="ignore", invalid="ignore"):
        across = direction[0] * along[:, 1] - direction[1] * along[:, 0]
        distance = (away[:, 0] * along[:, 1] - away[:, 1] * along[:, 0]) / across
        place = (away[:, 0] * direction[1] - away[:, 1] * direction[0]) / across
        is_hit = (place >= 0) & (place <= 1) & (distance > near)
    return float(distance[is_hit].min(initial=np.inf))


def _hit_triangles(
    start: FloatArray, direction: FloatArray, corners: FloatArray, near: float
) -> float:
    """Return the distance to the nearest triangle along a ray (Moeller and Trumbore, 1997)."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    away = start - corners[:, 0]
    across = np.cross(direction, second)
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = 1.0 / np.einsum("md,md->m", first, across)
        u = np.einsum("md,md->m", away, across) * scale
        turned = np.cross(away, first)
        v = turned @ direction * scale
        distance = np.einsum("md,md->m", second, turned) * scale
        is_hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (distance > near)
    return float(distance[is_hit].min(initial=np.inf))
