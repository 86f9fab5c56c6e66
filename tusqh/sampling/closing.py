r"""Split a geometry into a closed cycle and a small cap: ``soup = cycle + cap``.

The boundary of the soup is a 1-cycle with integer multiplicities; any chain of triangles with the
same boundary is a cap.  The winding number of ``soup - cap`` is an integer everywhere, so counting
crossings suffices for it; only the cap contributes fractions of a turn (algorithm 1).
A smaller cap costs less:

* a sheet with at least as many boundary edges as triangles is its own cap and is not closed;
* both sides of a crack are contracted to points between them, which gives slivers, not fans;
* the remaining boundary is split into simple loops: a triangle closes a loop of three edges, a fan
  closes a longer one.

The cap's additional points lie slightly off every plane and line of the loop, so a sample can lie
on an edge inside the cap only through a coincidence of rounding.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from tusqh.geometry.boundary_chain import (
    boundary_edges,
    boundary_points,
    cancel_edges,
    match_points,
)
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup import Soup
from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.grid.components import label_components

#: Displacement of added points, as a fraction of the loop's size; the components have irrational
#: ratios.
_OFF = np.array([1.0e-3 / np.sqrt(2), 1.0e-3 / np.sqrt(3), 1.0e-3 / np.sqrt(5)])
#: A crack is closed where its sides are nearer than this fraction of the shortest adjacent edge.
_CRACK = 0.5


@dataclass(frozen=True)
class Chain:
    """Triangles or segments with integer multiplicities.

    Parameters
    ----------
    corners
        Coordinates, shape (m, 3, 3) for triangles; for segments (m, 2, 3) in the plane y = 0.
    multiplicity
        Signed number of times each one counts, shape (m,).
    """

    corners: FloatArray
    multiplicity: IntArray

    def __len__(self) -> int:
        return len(self.multiplicity)


def close(geometry: Soup | Outline) -> tuple[Chain, Chain]:
    """Return a closed cycle and a cap whose sum is the geometry.

    Parameters
    ----------
    geometry
        A soup or an outline, which may have any defects.

    Returns
    -------
    cycle
        A chain without a boundary.
    cap
        The geometry less the cycle, kept small by a few rules.

    Examples
    --------
    A sheet is its own cap; the ends of an open polygon are joined.

    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> sheet = Soup(square, np.array([[0, 1, 2], [0, 2, 3]]), np.zeros(2, dtype=np.int64))
    >>> [len(chain) for chain in close(sheet)]
    [0, 2]
    >>> three_sides = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> [len(chain) for chain in close(Outline.from_chains([three_sides]))]
    [5, 2]
    """
    return _close_outline(geometry) if isinstance(geometry, Outline) else _close_soup(geometry)


def _close_soup(soup: Soup) -> tuple[Chain, Chain]:
    points, triangles = soup.matched()
    edges, net = boundary_edges(triangles, len(points))
    ones = np.ones(len(triangles), dtype=np.int64)
    if len(edges) == 0:
        return Chain(points[triangles], ones), Chain(np.empty((0, 3, 3)), ones[:0])
    is_open = _own_caps(triangles, edges, net, len(points))
    own = points[triangles[is_open]]
    if is_open.any():
        triangles = triangles[~is_open]
        edges, net = boundary_edges(triangles, len(points))
    candidates = [_fan_loops(points, edges, net), _zip_cracks(points, edges, net)]
    added = min((cap for cap in candidates if cap is not None), key=_area)
    cycle = np.concatenate([points[triangles], added.corners])
    of_cycle = np.concatenate([np.ones(len(triangles), dtype=np.int64), -added.multiplicity])
    cap = np.concatenate([own, added.corners])
    of_cap = np.concatenate([np.ones(len(own), dtype=np.int64), added.multiplicity])
    return Chain(cycle, of_cycle), Chain(cap, of_cap)


def _close_outline(outline: Outline) -> tuple[Chain, Chain]:
    """Join the end points; an outline with as many ends as segments is its own cap."""
    points, number = match_points(outline.points)
    segments = number[outline.segments]
    ends, net = boundary_points(segments, len(points))
    flat = np.stack([points[:, 0], np.zeros(len(points)), points[:, 1]], axis=1)
    ones = np.ones(len(segments), dtype=np.int64)
    if np.abs(net).sum() >= len(segments):
        return Chain(np.empty((0, 2, 3)), ones[:0]), Chain(flat[segments], ones)
    if len(ends) == 0:
        return Chain(flat[segments], ones), Chain(np.empty((0, 2, 3)), ones[:0])
    spokes, net = _join_ends(flat, ends, net)
    return (
        Chain(np.concatenate([flat[segments], spokes]), np.concatenate([ones, -net])),
        Chain(spokes, net),
    )


def _join_ends(flat: FloatArray, ends: IntArray, net: IntArray) -> tuple[FloatArray, IntArray]:
    """Return segments with the given end points: join near pairs, then the rest to a centre.

    Both ends of a pair are joined to a point midway, slightly off the line between them, so that no
    sample lies on the new segments.
    """
    from scipy.spatial import cKDTree

    places = flat[ends]
    left = net.copy()
    spokes, multiplicity = [], []
    for _ in range(3):  # Rounds of mutual nearest neighbours of opposite sign.
        index = np.flatnonzero(left)
        starts, stops = index[left[index] < 0], index[left[index] > 0]
        if len(starts) == 0:
            break
        _, to_stop = cKDTree(places[stops]).query(places[starts])
        _, to_start = cKDTree(places[starts]).query(places[stops])
        mutual = to_start[to_stop] == np.arange(len(starts))
        a, b = starts[mutual], stops[to_stop[mutual]]
        amount = np.minimum(-left[a], left[b])
        middle = _displaced((places[a] + places[b]) / 2, places[b] - places[a])
        middle[:, 1] = 0.0
        spokes += [np.stack([places[a], middle], 1), np.stack([middle, places[b]], 1)]
        multiplicity += [amount, amount]
        left[a] += amount
        left[b] -= amount
    index = np.flatnonzero(left)
    if len(index):
        size = np.ptp(places[index], axis=0).max(keepdims=True)
        centre = _displaced(places[index].mean(axis=0)[None], size[None])
        centre[:, 1] = 0.0
        spokes.append(np.stack([np.repeat(centre, len(index), axis=0), places[index]], 1))
        multiplicity.append(left[index])
    return np.concatenate(spokes), np.concatenate(multiplicity)


def _own_caps(triangles: IntArray, edges: IntArray, net: IntArray, n_points: int) -> BoolArray:
    """Return which triangles belong to sheets that are as large as the fans of their boundary."""
    m = len(triangles)
    nothing: BoolArray = np.zeros(m, dtype=bool)
    if np.abs(net).sum() * 8 < m and len(edges) * 8 < m:
        return nothing  # With so few open edges, sheets are not worth finding.
    sides = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    sides.sort(axis=1)
    _, of_side = np.unique(sides @ np.array([n_points, 1]), return_inverse=True)
    keys = edges @ np.array([n_points, 1])
    n_edges = int(of_side.max()) + 1
    rows = np.repeat(np.arange(m), 3)
    sheet, n_sheets = label_components(rows, m + of_side, m + n_edges)
    n_triangles = np.bincount(sheet[:m], minlength=n_sheets)
    edge_keys = np.unique(sides @ np.array([n_points, 1]))
    sheet_of_edge = sheet[m:][np.searchsorted(edge_keys, keys)]
    n_open = np.bincount(sheet_of_edge, weights=np.abs(net), minlength=n_sheets)
    return np.asarray((n_open >= n_triangles)[sheet[:m]])


def _zip_cracks(points: FloatArray, edges: IntArray, net: IntArray) -> Chain | None:
    """Return a cap that contracts near boundary points in pairs, or None if there are no pairs."""
    if len(edges) == 0:
        return None
    from scipy.spatial import cKDTree

    used, ends = np.unique(edges, return_inverse=True)
    ends = ends.reshape(-1, 2)
    places = points[used]
    lengths = np.linalg.norm(places[ends[:, 0]] - places[ends[:, 1]], axis=1)
    shortest = np.full(len(used), np.inf)
    np.minimum.at(shortest, ends.ravel(), np.repeat(lengths, 2))
    distance, nearest = cKDTree(places).query(places, k=2)
    partner, gap = nearest[:, 1], distance[:, 1]
    itself = np.arange(len(used))
    is_pair = (partner[partner] == itself) & (itself < partner)
    is_pair &= gap < _CRACK * np.minimum(shortest, shortest[partner])
    if not is_pair.any():
        return None
    a, b = itself[is_pair], partner[is_pair]
    middle = _displaced((places[a] + places[b]) / 2, places[b] - places[a])
    to = itself.copy()
    to[a] = to[b] = len(used) + np.arange(len(a))
    everything = np.concatenate([places, middle])
    # Put a strip between each edge and its image, without triangles whose corners coincide.
    s, e = ends.T
    strips = np.concatenate([np.stack([s, e, to[e]], 1), np.stack([s, to[e], to[s]], 1)])
    is_flat = (strips[:, 0] == strips[:, 1]) | (strips[:, 1] == strips[:, 2])
    is_flat |= strips[:, 0] == strips[:, 2]
    strip_net = np.concatenate([net, net])
    zipped, net = cancel_edges(to[ends], net, len(everything))
    rest = _fan_loops(everything, zipped, net)
    return Chain(
        np.concatenate([everything[strips[~is_flat]], rest.corners]),
        np.concatenate([strip_net[~is_flat], rest.multiplicity]),
    )


def _fan_loops(points: FloatArray, edges: IntArray, net: IntArray) -> Chain:
    """Return a triangle for each simple loop of three edges in a cycle, a fan for a longer one."""
    if len(edges) == 0:
        return Chain(np.empty((0, 3, 3)), np.empty(0, dtype=np.int64))
    forward = np.where((net > 0)[:, None], edges, edges[:, ::-1])
    directed = np.repeat(forward, np.abs(net), axis=0)
    walked, start = _walk_loops(directed, len(points))
    length = np.diff(start)
    of_step = np.repeat(np.arange(len(length)), length)
    following = walked[
        np.where(
            np.arange(1, len(walked) + 1) == start[1:][of_step],
            start[:-1][of_step],
            np.arange(1, len(walked) + 1) % len(walked),
        )
    ]
    corners = points[walked]
    centre = np.add.reduceat(corners, start[:-1], axis=0) / length[:, None]
    reach = np.maximum.reduceat(np.linalg.norm(corners - centre[of_step], axis=1), start[:-1])
    centre = _displaced(centre, reach[:, None])
    single, n_single = _unite(walked[start[:-1][length == 3][:, None] + np.arange(3)])
    is_fan = length[of_step] > 3
    fan = np.stack([centre[of_step], corners, points[following]], axis=1)[is_fan]
    multiplicity = np.concatenate([n_single, np.ones(len(fan), dtype=np.int64)])
    return Chain(np.concatenate([points[single], fan]), multiplicity)


def _unite(triangles: IntArray) -> tuple[IntArray, IntArray]:
    """Return distinct triangles and their multiplicities; opposite copies cancel."""
    lowest = triangles.argmin(axis=1)
    turned = np.take_along_axis(triangles, (lowest[:, None] + np.arange(3)) % 3, axis=1)
    is_odd = turned[:, 1] > turned[:, 2]
    turned[is_odd] = turned[is_odd][:, [0, 2, 1]]
    distinct, number = np.unique(turned, axis=0, return_inverse=True)
    net = np.bincount(number.ravel(), weights=np.where(is_odd, -1, 1)).astype(np.int64)
    return distinct[net != 0], net[net != 0]


@numba.njit(cache=True)
def _walk_loops(directed, n_points):  # type: ignore[no-untyped-def]
    """Split a balanced graph of directed edges into simple loops.

    Walk along unused edges and cut off a loop whenever the walk meets itself, so that loops are
    short.  Return the points of all loops one after another, and the start of each loop.
    """
    n = len(directed)
    first = np.zeros(n_points + 1, dtype=np.int64)
    for e in range(n):
        first[directed[e, 0] + 1] += 1
    for v in range(n_points):
        first[v + 1] += first[v]
    unused = first[:-1].copy()
    head = np.empty(n, dtype=np.int64)
    for e in range(n):
        head[unused[directed[e, 0]]] = directed[e, 1]
        unused[directed[e, 0]] += 1
    unused[:] = first[:-1]
    on_path = np.full(n_points, -1, dtype=np.int64)
    path = np.empty(n + 1, dtype=np.int64)
    walked = np.empty(n, dtype=np.int64)
    start = [0]
    n_walked = 0
    for e in range(n):
        v = directed[e, 0]
        if unused[v] == first[v + 1]:
            continue
        path[0], on_path[v], depth = v, 0, 1
        while depth > 0:
            v = path[depth - 1]
            if unused[v] == first[v + 1]:
                on_path[v] = -1
                depth -= 1
                continue
            w = head[unused[v]]
            unused[v] += 1
            if on_path[w] < 0:
                path[depth], on_path[w] = w, depth
                depth += 1
                continue
            for k in range(on_path[w], depth):
                walked[n_walked] = path[k]
                n_walked += 1
                if k > on_path[w]:
                    on_path[path[k]] = -1
            depth = on_path[w] + 1
            start.append(n_walked)
    return walked, np.array(start)


def _displaced(points: FloatArray, extent: FloatArray) -> FloatArray:
    """Return points moved off all planes by a fraction of an extent, shape (n, 3) or (n, 1)."""
    size = np.linalg.norm(np.atleast_2d(extent), axis=1, keepdims=True)
    return np.asarray(points + size * _OFF)


def _area(cap: Chain) -> float:
    """Return the area of a cap, weighted by the multiplicities of its triangles."""
    sides = cap.corners[:, 1:] - cap.corners[:, :1]
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2
    return float((areas * np.abs(cap.multiplicity)).sum())
