"""Make outlines from loose lines: chain them by their end points, with even-odd directions.

This is for formats that do not state what is inside.  Chains may have any direction.  Gaps are
dirty geometry and are not repaired: open chains are kept, and the winding number deals with them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from tusqh.geometry.remark import Remark
from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.readers.rings import (
    SLIP,
    crossing_area,
    even_odd_sides,
    first_of_copies,
    is_closed,
    regions_of,
    rings_of_region,
    settle,
    turned_remark,
)

#: Ends nearer than this fraction of the larger side of the drawing are one point.  It covers the
#: rounding of centres, radii and angles in files and is a hundredth of the tolerance of curves.
END_TOLERANCE = 1e-6

#: A chain whose gap is at most this fraction of its length counts as a ring and gets a direction.
SMALL_GAP = 0.1


def join_loose(chains: Sequence[FloatArray]) -> tuple[list[FloatArray], list[Remark]]:
    """Return loose chains joined to rings, all with the material on the same side.

    A ring that lies inside an odd number of other rings is a hole.  A chain that is drawn twice is
    used once.  Where three or more lines meet, the outer boundary of all faces between them is
    used.

    Parameters
    ----------
    chains
        Points of every chain, shape (k, 2), in file order.

    Returns
    -------
    chains, remarks
        Rings and chains that remain open, and remarks on changes.
    """
    kept = [chain for chain in chains if len(chain) > 1]
    if not kept or not all(np.isfinite(chain).all() for chain in kept):
        return list(chains), []
    unique = _without_copies(kept)
    joined = _join(unique)
    rings, sides, n_crossing = _resolve(joined.chains)
    settled, n_turned = settle(rings, sides)
    n_open = sum(not is_closed(chain) for chain in settled)
    counted = (
        ("left out", "lines and outlines that are drawn again", len(kept) - len(unique), ""),
        ("changed", "loose lines chained by their end points", joined.n_used, ""),
        ("left out", "lines that divide an outline or end inside it", joined.n_inner, ""),
        ("changed", "self-crossing outlines read by the even-odd rule", n_crossing, ""),
        ("noted", "chains that stay open", n_open, "check them, or the mesh"),
        ("noted", "pairs of outlines that cross", _count_crossings(rings), "use rule clamped"),
    )
    remarks = [Remark(e, what, n, remedy) for e, what, n, remedy in counted if n]  # type: ignore[arg-type]
    return settled, remarks + turned_remark(n_turned)


def _without_copies(chains: list[FloatArray]) -> list[FloatArray]:
    """Return the chains without copies, which have the same points in either direction."""
    seen: set[bytes] = set()
    kept = []
    for chain in chains:
        forward, backward = (chain + 0.0).tobytes(), (chain[::-1] + 0.0).tobytes()
        if forward not in seen and backward not in seen:
            kept.append(chain)
        seen.add(forward)
    numbers = [k for k, chain in enumerate(kept) if is_closed(chain) and len(chain) > 3]
    first = first_of_copies(regions_of([kept[k] for k in numbers]))
    again = {k for place, k in enumerate(numbers) if first[place] != place}
    return [chain for k, chain in enumerate(kept) if k not in again]


@dataclass
class _Joined:
    """Chains after joining, with the numbers of loose chains used and left out."""

    chains: list[FloatArray]
    n_used: int = 0
    n_inner: int = 0


def _join(chains: list[FloatArray]) -> _Joined:
    """Return the closed chains, and the loose chains after joining those whose ends meet."""
    loose = [k for k, chain in enumerate(chains) if not is_closed(chain)]
    if len(loose) == 0:
        return _Joined(chains)
    extent = float(np.ptp(np.concatenate(chains), axis=0).max())
    ends = np.array([[chains[k][0], chains[k][-1]] for k in loose]).reshape(-1, 2)
    nodes, places = _match_ends(ends, END_TOLERANCE * extent)
    edges = nodes.reshape(-1, 2)
    pair = (np.ones(len(edges)), (edges[:, 0], edges[:, 1]))
    _, label = connected_components(coo_array(pair, shape=(len(places),) * 2), directed=False)
    degree = np.bincount(edges.ravel(), minlength=len(places))
    branched = set(label[(degree % 2 == 1) & (degree > 1)].tolist())
    members: dict[int, list[int]] = {}
    for place, node in enumerate(edges[:, 0]):
        members.setdefault(int(label[node]), []).append(place)
    found = {k: [chain] for k, chain in enumerate(chains) if is_closed(chain)}
    result = _Joined([])
    for component, parts in members.items():
        own = [
            np.concatenate([places[edges[p, :1]], chains[loose[p]][1:-1], places[edges[p, 1:]]])
            for p in parts
        ]
        faces = _outer_rings(own) if component in branched else []
        if faces:
            result.n_inner += sum(not _is_part(chain, faces) for chain in own)
        found[loose[parts[0]]] = faces or _walk(own, edges[parts])
        result.n_used += len(parts) if len(parts) > 1 else 0
    result.chains = [chain for k in sorted(found) for chain in found[k]]
    return result


def _match_ends(ends: FloatArray, tolerance: float) -> tuple[IntArray, FloatArray]:
    """Return the index of the point at every end, and the points."""
    pairs = cKDTree(ends).query_pairs(tolerance, output_type="ndarray")
    pair = (np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1]))
    _, label = connected_components(coo_array(pair, shape=(len(ends),) * 2), directed=False)
    _, first = np.unique(label, return_index=True)
    return label.astype(np.int64), ends[first]


def _outer_rings(chains: list[FloatArray]) -> list[FloatArray]:
    """Return the outer rings of the faces that branching chains enclose."""
    lines = [shapely.linestrings(chain) for chain in chains]
    faces = shapely.get_parts(shapely.polygonize(lines))
    return rings_of_region(shapely.union_all(faces))[0] if len(faces) else []


def _is_part(chain: FloatArray, rings: list[FloatArray]) -> bool:
    """Return whether the first segment of a chain lies on a ring."""
    middle = shapely.points((chain[0] + chain[1]) / 2)
    size = float(np.ptp(chain[:2], axis=0).max())
    return any(shapely.distance(shapely.linearrings(ring), middle) < 1e-9 * size for ring in rings)


def _walk(chains: list[FloatArray], edges: IntArray) -> list[FloatArray]:
    """Return connected chains as rings and open walks; a walk that meets itself yields a ring."""
    unused: dict[int, list[int]] = {}
    for edge, (a, b) in enumerate(edges.tolist()):
        unused.setdefault(a, []).append(edge)
        if a != b:
            unused.setdefault(b, []).append(edge)
    is_used = np.zeros(len(edges), dtype=bool)
    walks = []
    for start in sorted(unused, key=lambda node: len(unused[node]) % 2 == 0):
        nodes, steps = [start], list[FloatArray]()
        place = {start: 0}
        while (k := _next(unused[nodes[-1]], is_used)) is not None:
            is_used[k] = True
            is_forward = bool(edges[k, 0] == nodes[-1])
            steps.append(chains[k] if is_forward else chains[k][::-1])
            node = int(edges[k, 1] if is_forward else edges[k, 0])
            if node in place:
                first = place[node]
                walks.append(_concatenated(steps[first:]))
                for left in nodes[first + 1 :]:
                    del place[left]
                del nodes[first + 1 :], steps[first:]
            else:
                place[node] = len(nodes)
                nodes.append(node)
        if steps:
            walks.append(_concatenated(steps))
    return walks


def _next(candidates: list[int], is_used: BoolArray) -> int | None:
    """Remove and return the first unvisited chain in a list."""
    while candidates:
        k = candidates.pop(0)
        if not is_used[k]:
            return k
    return None


def _concatenated(steps: list[FloatArray]) -> FloatArray:
    """Return consecutive chains as one chain."""
    return np.concatenate([steps[0][:1], *(step[1:] for step in steps)])


def _resolve(chains: list[FloatArray]) -> tuple[list[FloatArray], list[int], int]:
    """Return rings without self-crossings, their sides, and the number of replaced rings.

    Open chains have a side if their gap is small; otherwise they keep their direction.
    """
    is_ring = [_is_nearly_closed(chain) for chain in chains]
    regions = regions_of([chain for chain, ring in zip(chains, is_ring, strict=True) if ring])
    of_rings = iter(zip(regions, even_odd_sides(regions), strict=True))
    resolved: list[FloatArray] = []
    sides: list[int] = []
    n_replaced = 0
    for chain, ring in zip(chains, is_ring, strict=True):
        region, side = next(of_rings) if ring else (None, 0)
        if ring and is_closed(chain) and crossing_area(chain, region) > SLIP:
            pieces, of_pieces = rings_of_region(region)
            resolved += pieces
            sides += [int(side) * of_piece for of_piece in of_pieces]
            n_replaced += 1
        else:
            resolved.append(chain)
            sides.append(int(side))
    return resolved, sides, n_replaced


def _is_nearly_closed(chain: FloatArray) -> bool:
    """Return whether a chain is a ring except for a small gap."""
    if len(chain) < 4 - (not is_closed(chain)):
        return False
    length = np.linalg.norm(np.diff(chain, axis=0), axis=1).sum()
    return bool(np.linalg.norm(chain[0] - chain[-1]) <= SMALL_GAP * length)


def _count_crossings(rings: list[FloatArray]) -> int:
    """Return the number of pairs of rings that overlap without one lying inside the other."""
    regions = regions_of([ring for ring in rings if is_closed(ring) and len(ring) > 3])
    first, second = shapely.STRtree(regions).query(regions, predicate="overlaps")
    return int((first < second).sum())
