"""The rounds of fitting: untangle the layer, follow the level set, planes, polish."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tusqh.fitting.distances import on_sides
from tusqh.fitting.level_set import pad_level, project
from tusqh.fitting.moving import Moving
from tusqh.fitting.nearest_sample import Bins, find_samples, sort_samples
from tusqh.fitting.pillow import pillow
from tusqh.fitting.planes import FitTerms, Planes, choose, combine, squares
from tusqh.fitting.skin import Skin, unit
from tusqh.fitting.target import Target, to_cells
from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.meshes.element_mesh import ElementMesh

_LOG = logging.getLogger("tusqh")

#: How far the old boundary moves inwards at first, in cells.
_INWARDS = 0.3
#: Largest distance from the staircase to the target, in cells.
_CAP = 1.25
#: Weight of a vertex' own planes; those of its facets have the rest.
_OWN = 1 / 3
#: Thresholds this near 1/2 need no way along the level sets.
_SAME = 0.02
#: Weights of the fit term in the rounds of planes.
_WEIGHTS = (10.0, 20.0, 50.0, 100.0, 200.0, 400.0, 400.0)
#: Scaled Jacobian that the polish wishes for, and that ends it.
_WISH, _ENOUGH = 0.5, 0.46
#: Weight of the fit term that leads to the smoothed staircase.
_CALM = 100.0
#: Weight of the fit term that holds a vertex where it is, in the polish.
_HOLD = 10.0
#: Rounds of the polish, and the factor of the weights around bad hexes in each.
_POLISHES, _RELEASE = 6, 0.25


@dataclass
class Rounds:
    """A mesh on its way to the target; lengths in cells.

    Parameters
    ----------
    moving
        The hexes, with the layer.
    skin
        Their boundary.
    target
        The target.
    is_owned
        Boundary facets that belong to a surface: not on a side and not changed on purpose.
    covers
        Element that each hex of the layer covers.
    anchor
        Places of the boundary vertices from which they may go no farther than `_CAP`, shape (b, 3).
    calm
        Fit terms that lead to the smoothed staircase.
    """

    moving: Moving
    skin: Skin
    target: Target
    is_owned: BoolArray
    covers: IntArray
    anchor: FloatArray
    calm: FitTerms

    @classmethod
    def of(
        cls,
        mesh: ElementMesh,
        target: Target,
        fixed: BoolArray | None = None,
        is_covered: BoolArray | None = None,
    ) -> Rounds:
        """Return a mesh with a layer, before anything is fitted.

        Parameters
        ----------
        mesh
            The mesh.
        target
            The target.
        fixed
            Points that do not move, shape (n,).
        is_covered
            Boundary facets that get a hex of the layer, see `tusqh.fitting.pillow.pillow`.
        """
        pillowed = pillow(mesh, is_covered)
        points = to_cells(pillowed.points, target.grid)
        skin = Skin.of(pillowed.facets)
        free = np.full(len(points), 7, dtype=np.int64)
        is_on = on_sides(points[pillowed.facets], target)
        for side in range(is_on.shape[1]):
            axis, at = side // 2, pillowed.facets[is_on[:, side]]
            free[at] &= ~(1 << axis)
            if target.sides is not None and (is_covered is None or is_covered.all()):
                points[at, axis] = target.sides[side % 2, axis]
        if fixed is not None:
            new = np.arange(len(points))
            new[pillowed.inside] = pillowed.outside
            free[new[np.flatnonzero(fixed)]] = 0
        is_owned = ~is_on.any(axis=1) & ~_is_changed(points[pillowed.facets], target)
        anchor = points[skin.vertices]
        normals, _ = skin.normals(anchor)
        inwards = np.zeros_like(points)
        inwards[skin.vertices] = _INWARDS * normals
        points[pillowed.inside] -= inwards[pillowed.outside]
        moving = Moving.of(points, pillowed.cells, skin.vertices, free)
        matrix = squares(normals)
        matrix[:, :3] += 0.1
        calm = FitTerms(matrix, skin.smooth_apart(anchor, 3))
        return cls(moving, skin, target, is_owned, pillowed.covers, anchor, calm)

    @property
    def places(self) -> FloatArray:
        """Places of the boundary vertices, shape (b, 3)."""
        return np.asarray(self.moving.points[self.skin.vertices])

    @cached_property
    def bins(self) -> Bins:
        """The samples of the target."""
        return sort_samples(self.target.points, self.target.normals)

    @cached_property
    def padded(self) -> FloatArray:
        """The padded fractions of the target."""
        return pad_level(self.target)

    @cached_property
    def is_own(self) -> BoolArray:
        """Boundary vertices with a facet that belongs to a surface, shape (b,)."""
        found = np.zeros(self.skin.n_vertices, dtype=np.bool_)
        found[self.skin.facets[self.is_owned]] = True
        return found

    def fit(self, threshold: float) -> None:
        """Fit the boundary of untangled hexes.

        Parameters
        ----------
        threshold
            The threshold of the mesh.
        """
        if abs(threshold - 0.5) > _SAME:
            self.follow(threshold)
        for weight in _WEIGHTS:
            self.approach(weight)
        self.polish()

    def untangle(self) -> None:
        """Move the layer apart while the boundary goes to the smoothed staircase."""
        self.moving.aim(self.skin.vertices, self.calm, np.full(self.skin.n_vertices, 5.0))
        self.moving.sweep(4, is_wild=True)
        self._log("untangled, wildly")
        for _ in range(10):
            if self.moving.quality.determinant.min() > 0:
                break
            self.moving.sweep(2)
            self._log("untangled")
        self.moving.aim(self.skin.vertices, self.calm, np.full(self.skin.n_vertices, _CALM))
        self.moving.sweep(3)
        self._log("calm")

    def hold(self, chosen: BoolArray) -> None:
        """Let the fit terms of some boundary vertices hold them where they are.

        Parameters
        ----------
        chosen
            Vertices of the mesh, shape (n,).
        """
        vertices = self.skin.vertices[chosen[self.skin.vertices]]
        matrix = np.zeros((len(vertices), 6))
        matrix[:, :3] = 1.0
        terms = FitTerms(matrix, self.moving.points[vertices])
        self.moving.aim(vertices, terms, np.full(len(vertices), _HOLD))

    def follow(self, threshold: float) -> None:
        """Follow the level sets from the threshold of the mesh to 1/2.

        Parameters
        ----------
        threshold
            The threshold of the mesh.
        """
        for step, weight in ((1 / 3, 5.0), (2 / 3, 7.0), (1.0, 10.0)):
            terms, is_found = self.level_terms(threshold + (0.5 - threshold) * step)
            weights = np.where(is_found, weight, 3.0)
            self.moving.aim(self.skin.vertices, choose(is_found, terms, self.calm), weights)
            self.moving.sweep(3)
        self.anchor = np.where(is_found[:, None], self.places, self.anchor)
        self._log("followed")

    def level_terms(self, value: float) -> tuple[FitTerms, BoolArray]:
        """Return the fit terms of a level set, and where it is near.

        Parameters
        ----------
        value
            The fraction.

        Returns
        -------
        terms
            The fit terms of all boundary vertices.
        is_found
            Where they count, shape (b,).
        """
        places = self.places
        found = project(self.padded, places, value)
        normals, _ = self.skin.normals(places, self.is_owned)
        is_found = found.is_found & ((found.normals * normals).sum(axis=1) > 0) & self.is_own
        is_found &= np.linalg.norm(found.points - self.anchor, axis=1) <= _CAP
        matrix = squares(found.normals)
        matrix[:, :3] += 0.003
        return FitTerms(matrix, found.points), is_found

    def sample_terms(self) -> tuple[FitTerms, BoolArray]:
        """Return the fit terms of the planes of samples, and where there are any.

        Returns
        -------
        terms
            The fit terms of all boundary vertices.
        is_found
            Where they count, shape (b,).
        """
        places = self.places
        facets = self.skin.facets
        normals, areas = self.skin.normals(places, self.is_owned)
        own = find_samples(self.bins, places, normals, _CAP)
        is_found = own.is_found & self.is_own
        is_found &= np.linalg.norm(own.points - self.anchor, axis=1) <= _CAP
        towards = unit(unit(areas) + 0.3 * normals[facets].mean(axis=1))
        centre = places[facets].mean(axis=1)
        of_facets = find_samples(self.bins, centre, towards, _CAP)
        weight = (of_facets.is_found & self.is_owned).astype(np.float64)
        terms = combine(
            places,
            Planes(np.arange(len(places)), own.points, own.normals, np.where(is_found, _OWN, 0.0)),
            Planes(np.arange(len(facets)), of_facets.points, of_facets.normals, weight),
            facets,
            np.full(len(places), 1 - _OWN),
        )
        terms.matrix[:, :3] += 0.002
        return terms, is_found

    def approach(self, weight: float) -> None:
        """Move the boundary towards the planes of samples, else to the 1/2 level set.

        Parameters
        ----------
        weight
            Weight of the fit term.
        """
        terms, is_found = self.sample_terms()
        level, is_level = self.level_terms(0.5)
        both = choose(is_found, terms, choose(is_level, level, self.calm))
        weights = np.where(is_found, weight, np.where(is_level, min(weight, 10.0), 3.0))
        self.moving.aim(self.skin.vertices, both, weights)
        self.moving.sweep(3, power=2)
        self._log(f"weight {weight}, {is_found.mean():.3f} on samples, {is_level.mean():.3f}")

    def polish(self) -> None:
        """Raise the smallest scaled Jacobians, with weaker fit terms around the worst hexes."""
        for round_ in range(_POLISHES):
            scaled = self.moving.quality.scaled
            if scaled.min() >= _ENOUGH:
                return
            if round_ > 0:
                around = np.unique(self.moving.cells[scaled < _ENOUGH])
                self.moving.weight[around] *= _RELEASE
            self.moving.moved[:] = 1.0
            self.moving.sweep(4, wish=_WISH, longest=0.1)
            self._log("polished")

    def _log(self, what: str) -> None:
        """Log the worst hex."""
        found = self.moving.quality
        _LOG.debug(
            "%s: least scaled Jacobian %.4f, %d tangled",
            what,
            found.scaled.min(),
            (found.determinant <= 0).sum(),
        )


def _is_changed(corners: FloatArray, target: Target) -> BoolArray:
    """Return which facets lie beside a cell that was changed on purpose, shape (f,)."""
    if target.changed is None:
        return np.zeros(len(corners), dtype=np.bool_)
    centre = corners.mean(axis=1)
    normal = unit(np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]))
    found = np.zeros(len(corners), dtype=np.bool_)
    upper = np.array(target.grid.shape) - 1
    for way in (-0.25, 0.25):
        place = np.clip(np.floor(centre + way * normal).astype(np.int64), 0, upper)
        found |= target.changed[tuple(place.T)]
    return found
