"""Feature edges of a boundary: borders of patches at which the surface has a crease."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components

from tusqh.fitting.nearest_sample import Bins, find_samples, sort_samples
from tusqh.fitting.patches import find_patches, label_facets, neighbours_of
from tusqh.fitting.planes import Planes
from tusqh.fitting.skin import Skin, unit
from tusqh.fitting.target import Target
from tusqh.grid import BoolArray, FloatArray, IntArray

#: Creases bend by more than this, and patches join where normals differ by less, in degrees.
CREASE, SMOOTH = 30.0, 35.0
#: Farthest patch from a feature edge, in cells, and fewest edges of a chain.
_NEAR, SHORTEST = 1.5, 4
#: Weights with which vertices are spread along a chain, and beside its ends; planes of patches have
#: 1.
_SPREAD, _SPREAD_AT_END = 0.005, 0.1
#: Farthest plane of a patch from a feature vertex, in cells.
_FAR = 2.5
#: How much stronger vertices of feature edges and corners are pulled, and by which factor the pull
#: falls in each round where hexes are bad.
_AT_EDGE, _AT_CORNER = 5.0, 25.0
_RELEASE_EDGE, _RELEASE_CORNER = 0.5, 0.8
#: Most edges of a row between creases that counts as a crease, too.
_GAP = 4


@dataclass(frozen=True)
class Features:
    """Feature edges between the patches of boundary facets.

    Parameters
    ----------
    label
        Patch of every facet, -1 for none, shape (f,).
    edges
        Ends of the feature edges, rows of the skin's vertices, shape (e, 2).
    vertex, patch
        Pairs of a feature vertex and a patch of one of its facets, shape (p,) each.
    """

    label: IntArray
    edges: IntArray
    vertex: IntArray
    patch: IntArray

    def is_on(self, n: int) -> BoolArray:
        """Return which of n vertices of the skin lie on a feature edge, shape (n,).

        Parameters
        ----------
        n
            Number of vertices.
        """
        found = np.zeros(n, dtype=np.bool_)
        found[self.edges] = True
        return found

    def corners(self, n: int) -> BoolArray:
        """Return which of n vertices of the skin are corners, where 3 patches meet, shape (n,).

        Parameters
        ----------
        n
            Number of vertices.
        """
        return np.asarray(np.bincount(self.vertex, minlength=n) >= 3)

    def strength(self, n: int) -> FloatArray:
        """Return how much stronger each of n vertices of the skin is pulled, shape (n,).

        Parameters
        ----------
        n
            Number of vertices.
        """
        return np.where(self.corners(n), _AT_CORNER, np.where(self.is_on(n), _AT_EDGE, 1.0))

    def release(self, n: int, usual: float) -> FloatArray:
        """Return by which factor the pull of each vertex falls where hexes are bad, shape (n,).

        Parameters
        ----------
        n
            Number of vertices.
        usual
            The factor of vertices that are not on a feature edge.
        """
        of_edges = np.where(self.is_on(n), _RELEASE_EDGE, usual)
        return np.where(self.corners(n), _RELEASE_CORNER, of_edges)

    def planes(
        self, bins: Bins, places: FloatArray, normals: FloatArray, anchor: FloatArray
    ) -> Planes:
        """Return one plane of every patch around every feature vertex.

        Parameters
        ----------
        bins
            The samples with their patches.
        places, normals
            Places and normals of the skin's vertices, shape (b, 3) each.
        anchor
            Places from which planes may not be too far, shape (b, 3).
        """
        rows = self.vertex
        found = find_samples(
            bins, places[rows], normals[rows], _FAR, self.patch, turn=0.1, reach=_FAR
        )
        away = np.linalg.norm(found.points - anchor[rows], axis=1)
        weight = np.where(found.is_found & (away <= _FAR), 1.0, 0.0)
        return Planes(rows, found.points, found.normals, weight)

    def spread(self, places: FloatArray) -> Planes:
        """Return planes across the chains that spread vertices evenly along them.

        Without them vertices beside a corner may slide beyond it, as planes of patches do not end.

        Parameters
        ----------
        places
            Places of the skin's vertices, shape (b, 3).
        """
        both = np.concatenate([self.edges, self.edges[:, ::-1]])
        both = both[np.argsort(both[:, 0], kind="stable")]
        degree = np.bincount(both[:, 0], minlength=len(places))
        ends = both[degree[both[:, 0]] == 2]
        rows, (one, other) = ends[::2, 0], ends[:, 1].reshape(-1, 2).T
        middle = (places[one] + places[other]) / 2
        along = unit(places[other] - places[one])
        is_at_end = (degree[one] != 2) | (degree[other] != 2)
        return Planes(rows, middle, along, np.where(is_at_end, _SPREAD_AT_END, _SPREAD))

    def averages(self, skin: Skin) -> csr_array:
        """Return the matrix of means of neighbours; along chains, and corners stay.

        Parameters
        ----------
        skin
            The boundary.
        """
        n = skin.n_vertices
        start, end = self.edges.T
        pairs = np.concatenate([start, end]), np.concatenate([end, start])
        along = coo_array((np.ones(2 * len(start)), pairs), shape=(n, n)).tocsr()
        degree = np.asarray(along.sum(axis=1)).ravel()
        is_on, is_middle = degree > 0, degree == 2
        keep = coo_array((np.ones(n), (np.arange(n), np.arange(n))), shape=(n, n)).tocsr()

        def chosen(matrix: csr_array, factor: FloatArray) -> csr_array:
            diagonal = coo_array((factor, (np.arange(n), np.arange(n))), shape=(n, n)).tocsr()
            return diagonal @ matrix

        return (
            chosen(skin.averages, np.where(is_on, 0.0, 1.0))
            + chosen(along, np.where(is_middle, 0.5, 0.0))
            + chosen(keep, np.where(is_on & ~is_middle, 1.0, 0.0))
        ).tocsr()


def find_features(
    target: Target, skin: Skin, places: FloatArray, is_owned: BoolArray
) -> tuple[Bins, Features] | None:
    """Return samples with patches and the feature edges between them; None if there are none.

    Parameters
    ----------
    target
        The target.
    skin
        The boundary.
    places
        Places of its vertices, shape (b, 3).
    is_owned
        Facets that belong to a surface, shape (f,).

    Returns
    -------
    found
        The samples in bins, and the feature edges.
    """
    patch = find_patches(target, SMOOTH)
    if patch.max(initial=-1) < 1:
        return None
    bins = sort_samples(target.points, target.normals, patch)
    label = label_facets(bins, skin, places, is_owned)
    edges = _crease_edges(bins, skin, places, label)
    edges = _long_chains(edges, skin.n_vertices)
    if len(edges) == 0:
        return None
    is_on = np.zeros(skin.n_vertices, dtype=np.bool_)
    is_on[edges] = True
    vertex, patches = skin.facets.ravel(), np.repeat(label, 4)
    counts = is_on[vertex] & (patches >= 0)
    pairs = np.unique(np.stack([vertex[counts], patches[counts]], axis=1), axis=0)
    return bins, Features(label, edges, pairs[:, 0], pairs[:, 1])


def _crease_edges(bins: Bins, skin: Skin, places: FloatArray, label: IntArray) -> IntArray:
    """Return the edges between facets of two patches that are near and bend there."""
    across = (neighbours_of(skin) // 4).ravel()
    facet, corner = np.divmod(np.arange(4 * len(label)), 4)
    is_border = (label[facet] != label[across]) & (facet < across)
    is_border &= (label[facet] >= 0) & (label[across] >= 0)
    facet, across, corner = facet[is_border], across[is_border], corner[is_border]
    edges = np.stack([skin.facets[facet, corner], skin.facets[facet, (corner + 1) % 4]], axis=1)
    middle = places[edges].mean(axis=1)
    normals = skin.normals(places)[0][edges].sum(axis=1) / 2
    one = find_samples(bins, middle, normals, _NEAR, label[facet], turn=0.1, reach=_NEAR)
    other = find_samples(bins, middle, normals, _NEAR, label[across], turn=0.1, reach=_NEAR)
    bend = np.einsum("ek,ek->e", one.normals, other.normals) < np.cos(np.radians(CREASE))
    is_crease = one.is_found & other.is_found & bend
    pair = np.sort(np.stack([label[facet], label[across]], axis=1), axis=1)
    return np.asarray(edges[is_crease | _gaps(edges, pair, is_crease)])


def _gaps(edges: IntArray, pair: IntArray, is_crease: BoolArray) -> BoolArray:
    """Return short rows of other edges between creases of the same two patches, or to a corner."""
    rest = np.flatnonzero(~is_crease)
    n = int(edges.max(initial=0)) + 1
    name = np.unique(pair, axis=0, return_inverse=True)[1].ravel()
    node = edges + n * name[:, None]
    places, local = np.unique(node, return_inverse=True)
    local = local.reshape(-1, 2)
    graph = coo_array((np.ones(len(rest)), tuple(local[rest].T)), shape=(len(places),) * 2)
    run = connected_components(graph, directed=False)[1]
    degree = np.bincount(local[rest].ravel(), minlength=len(places))
    has_crease = np.bincount(local[is_crease].ravel(), minlength=len(places)) > 0
    n_pairs = np.bincount(places % n, minlength=n)[places % n]
    is_end = degree == 1
    is_bad = is_end & ~has_crease & (n_pairs < 2)
    n_runs = int(run.max(initial=-1)) + 1
    length = np.bincount(run[local[rest, 0]], minlength=n_runs)
    is_good = length <= _GAP
    is_good &= np.bincount(run[is_bad], minlength=n_runs) == 0
    is_good &= np.bincount(run[has_crease & (degree > 0)], minlength=n_runs) > 0
    found = np.zeros(len(edges), dtype=np.bool_)
    found[rest] = is_good[run[local[rest, 0]]]
    return found


def _long_chains(edges: IntArray, n: int) -> IntArray:
    """Return the edges of connected chains that are not too short."""
    graph = coo_array((np.ones(len(edges)), tuple(edges.T)), shape=(n, n))
    number = connected_components(graph, directed=False)[1][edges[:, 0]]
    length = np.bincount(number, minlength=1)
    return np.asarray(edges[length[number] >= SHORTEST])
