"""The rounds of fitting: untangle the layer, follow the level set, planes, polish."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tusqh.fitting.distances import is_beside_change, on_sides
from tusqh.fitting.features import Features, find_features
from tusqh.fitting.level_set import pad_level, project
from tusqh.fitting.moving import Moving
from tusqh.fitting.nearest_sample import Bins, find_samples, sort_samples
from tusqh.fitting.pillow import pillow
from tusqh.fitting.planes import FitTerms, Planes, choose, combine, squares
from tusqh.fitting.polish import RELEASE, polish
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
#: From this weight on, feature edges take more sweeps to settle.
_LATE = 200.0
#: Scaled Jacobian that each hex should reach in the polish.
_ENOUGH = 0.46
#: The same at feature edges, where a facet may have a corner of nearly 180 degrees.
_ENOUGH_SHARP = 0.31
#: Weight of the fit term that leads to the smoothed staircase.
_CALM = 100.0
#: Weight of the fit term that holds a vertex where it is, in the polish.
_HOLD = 10.0


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
    bins
        The samples of the target, with their patches if there are features.
    features
        The feature edges; None if there are none.
    held
        Vertices of the mesh whose fit terms do not give way in the polish, shape (n,); None: none.
    """

    moving: Moving
    skin: Skin
    target: Target
    is_owned: BoolArray
    covers: IntArray
    anchor: FloatArray
    calm: FitTerms
    bins: Bins
    features: Features | None
    held: BoolArray | None = None

    @classmethod
    def of(
        cls,
        mesh: ElementMesh,
        target: Target,
        fixed: BoolArray | None = None,
        is_covered: BoolArray | None = None,
        has_features: bool = True,
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
        has_features
            Whether creases of the surface become feature edges.
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
        is_owned = ~is_on.any(axis=1) & ~is_beside_change(points[pillowed.facets], target)
        anchor = points[skin.vertices]
        normals, _ = skin.normals(anchor)
        inwards = np.zeros_like(points)
        inwards[skin.vertices] = _INWARDS * normals
        points[pillowed.inside] -= inwards[pillowed.outside]
        moving = Moving.of(points, pillowed.cells, skin.vertices, free)
        found = find_features(target, skin, anchor, is_owned) if has_features else None
        bins, features = found or (sort_samples(target.points, target.normals), None)
        averages = None if features is None else features.averages(skin)
        matrix = squares(normals)
        matrix[:, :3] += 0.1
        if features is not None:
            matrix[features.vertex, :3] += 0.4
        calm = FitTerms(matrix, skin.smooth_apart(anchor, 3, averages))
        layers = pillowed.covers
        return cls(moving, skin, target, is_owned, layers, anchor, calm, bins, features)

    @property
    def places(self) -> FloatArray:
        """Places of the boundary vertices, shape (b, 3)."""
        return np.asarray(self.moving.points[self.skin.vertices])

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

    @property
    def is_beside_change(self) -> BoolArray:
        """Boundary vertices that belong to no surface and are not on a side, shape (b,)."""
        facets = self.skin.facets
        on_side = on_sides(self.places[facets], self.target).any(axis=1)
        found = ~self.is_own
        found[facets[on_side]] = False
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

    def hold(self, chosen: BoolArray, weight: float = _HOLD, *, gives_way: bool = True) -> None:
        """Let the fit terms of some boundary vertices hold them where they are.

        Parameters
        ----------
        chosen
            Vertices of the mesh, shape (n,).
        weight
            Weight of the fit terms.
        gives_way
            Whether the polish may lower the weight where hexes are bad.
        """
        vertices = self.skin.vertices[chosen[self.skin.vertices]]
        matrix = np.zeros((len(vertices), 6))
        matrix[:, :3] = 1.0
        terms = FitTerms(matrix, self.moving.points[vertices])
        self.moving.aim(vertices, terms, np.full(len(vertices), weight))
        self.held = None if gives_way else chosen

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
        places, facets, features = self.places, self.skin.facets, self.features
        normals, areas = self.skin.normals(places, self.is_owned)
        own = find_samples(self.bins, places, normals, _CAP)
        is_found = own.is_found & self.is_own
        is_found &= np.linalg.norm(own.points - self.anchor, axis=1) <= _CAP
        towards = unit(unit(areas) + 0.3 * normals[facets].mean(axis=1))
        centre = places[facets].mean(axis=1)
        label = None if features is None else np.where(features.label < 0, -2, features.label)
        found = find_samples(self.bins, centre, towards, _CAP, label)
        weight = (found.is_found & self.is_owned).astype(np.float64)
        share = np.full(len(places), 1 - _OWN)
        planes = [
            Planes(np.arange(len(places)), own.points, own.normals, np.where(is_found, _OWN, 0.0))
        ]
        if features is not None:
            is_on = features.is_on(len(places))
            share[is_on] = 0.0
            planes[0].weight[is_on] = 0.0
            planes += [
                features.planes(self.bins, places, normals, self.anchor),
                features.spread(places),
            ]
            is_found[is_on] = False
            is_found[planes[1].row[planes[1].weight > 0]] = True
        of_facets = Planes(np.arange(len(facets)), found.points, found.normals, weight)
        terms = combine(places, planes, of_facets, facets, share)
        terms.matrix[:, :3] += 0.002
        return terms, is_found

    @cached_property
    def strength(self) -> FloatArray:
        """How much stronger each boundary vertex is pulled: more at features, shape (b,)."""
        n = self.skin.n_vertices
        return np.ones(n) if self.features is None else self.features.strength(n)

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
        weights *= np.where(is_found, self.strength, 1.0)
        self.moving.aim(self.skin.vertices, both, weights)
        is_late = self.features is not None and weight >= _LATE
        self.moving.sweep(6 if is_late else 3, power=2)
        self._log(f"weight {weight}, {is_found.mean():.3f} on samples, {is_level.mean():.3f}")

    def polish(self) -> None:
        """Raise the smallest scaled Jacobians, see `tusqh.fitting.polish.polish`."""
        release = None
        if self.features is not None:
            release = np.full(len(self.moving.points), RELEASE)
            release[self.skin.vertices] = self.features.release(self.skin.n_vertices, RELEASE)
        polish(self.moving, self.enough, self.held, release)

    @cached_property
    def enough(self) -> FloatArray:
        """Scaled Jacobian that each hex should reach; less at features, shape (m,)."""
        wanted = np.full(len(self.moving.cells), _ENOUGH)
        if self.features is not None:
            is_on = np.zeros(len(self.moving.points), dtype=np.bool_)
            is_on[self.skin.vertices[self.features.vertex]] = True
            wanted[is_on[self.moving.cells].any(axis=1)] = _ENOUGH_SHARP
        return wanted

    def _log(self, what: str) -> None:
        """Log the worst hex."""
        found = self.moving.quality
        _LOG.debug(
            "%s: least scaled Jacobian %.4f, %d tangled",
            what,
            found.scaled.min(),
            (found.determinant <= 0).sum(),
        )
