"""Say what is dirty about an outline: measured, never repaired."""

from __future__ import annotations

import numpy as np
import pandas as pd
from scipy.spatial import cKDTree

from tusqh.geometry.borders import measure_slivers
from tusqh.geometry.outline import Outline
from tusqh.geometry.segment_pairs import compare_segments
from tusqh.grid import BoolArray, FloatArray, IntArray

#: A closed chain turns neither way when its area is below this part of the bounding square:
#: that much is the rounding of the sum that gives the area.
FLAT_AREA = 1e-13

_NO_LENGTH = float("nan")
_LENGTH, _AREA, _PLAIN = "model units", "model units^2", "-"


def describe_defects(outline: Outline) -> pd.DataFrame:
    """Return one row for each kind of defect, always the same rows in the same order.

    Dirty geometry is input, not an error; every kind is reported, found or not.

    Returns
    -------
    pandas.DataFrame
        Columns ``defect``, ``count``, ``length_or_width`` (what it means is said in
        ``explanation``; NaN where there is nothing to measure), ``unit`` and ``explanation``.

    Notes
    -----
    Points are the same when their coordinates are equal in every bit.  None of the rows depends
    on the order of the segments; reversing all of them swaps ``counter_clockwise_chains`` with
    ``clockwise_chains``, changes the sign of ``signed_area``, and nothing else.

    Examples
    --------
    >>> import numpy as np
    >>> bow_tie = np.array([[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0], [0.0, 0.0]])
    >>> table = describe_defects(Outline.from_chains([bow_tie])).set_index("defect")
    >>> int(table["count"]["crossings"]), int(table["count"]["open_ends"])
    (1, 0)
    """
    points, segments = _distinct_points(outline)
    chain_numbers, chains = np.unique(outline.chains, return_inverse=True)
    lengths = np.linalg.norm(points[segments[:, 1]] - points[segments[:, 0]], axis=1)
    n_chains = len(chain_numbers)
    chain_lengths: FloatArray = np.bincount(chains, weights=lengths, minlength=n_chains).astype(
        np.float64
    )
    is_closed = _closed_chains(segments, chains, n_chains)
    areas = np.where(is_closed, _signed_areas(points, segments, chains, n_chains), 0.0)
    multiplicity = np.bincount(segments[:, 1], minlength=len(points)) - np.bincount(
        segments[:, 0], minlength=len(points)
    )
    open_ends = np.flatnonzero(multiplicity)
    end_gaps = _nearest_distances(points[open_ends])
    copies = _copies(segments, lengths)
    pairs = compare_segments(points, segments)
    in_closed = is_closed[chains]
    slivers = measure_slivers(
        points,
        segments[in_closed],
        (np.cumsum(is_closed) - 1)[chains[in_closed]],
        areas=areas[is_closed],
    )
    rows: list[tuple[str, int, float, str, str]] = [
        ("segments", len(segments), lengths.sum(), _LENGTH, "all segments; their total length"),
        (
            "chains",
            n_chains,
            chain_lengths.max(),
            _LENGTH,
            "rings, polylines or paths of the file; the longest one",
        ),
        (
            "zero_length_segments",
            int((segments[:, 0] == segments[:, 1]).sum()),
            0.0,
            _LENGTH,
            "segments that start and end in the same point; their length",
        ),
        (
            "closed_chains",
            int(is_closed.sum()),
            chain_lengths[is_closed].sum(),
            _LENGTH,
            "chains whose signed boundary cancels; their total length",
        ),
        (
            "open_chains",
            int((~is_closed).sum()),
            chain_lengths[~is_closed].sum(),
            _LENGTH,
            "chains whose signed boundary does not cancel; their total length",
        ),
        (
            "open_ends",
            len(open_ends),
            float(np.abs(multiplicity).max()),
            _PLAIN,
            "points where segment ends (+1) and starts (-1) of the whole outline do not cancel; "
            "the largest sum",
        ),
        (
            "duplicate_segments",
            *copies["duplicate"],
            _LENGTH,
            "surplus copies with the same ends and direction; their total length",
        ),
        (
            "opposite_segments",
            *copies["opposite"],
            _LENGTH,
            "pairs with the same ends in opposite directions; their total length",
        ),
        (
            "overlapping_segments",
            len(pairs.overlaps),
            pairs.shared_lengths.sum(),
            _LENGTH,
            "collinear pairs that share a length without being the same; the shared length",
        ),
        (
            "crossings",
            len(pairs.crossings),
            _NO_LENGTH,
            _PLAIN,
            "pairs of segments whose interiors cross",
        ),
        (
            "touching",
            len(pairs.touching),
            _NO_LENGTH,
            _PLAIN,
            "end points that lie inside another, not collinear segment",
        ),
        (
            "end_gaps",
            len(end_gaps),
            end_gaps.max(initial=0.0),
            _LENGTH,
            "open ends that have another open end to reach; the largest distance to the nearest",
        ),
        (
            "border_gaps",
            len(slivers.gaps),
            slivers.gaps.max(initial=0.0),
            _LENGTH,
            "bounded pieces between closed chains that none of them covers, enclosed water "
            "included; the largest width (2 area / perimeter)",
        ),
        (
            "border_overlaps",
            len(slivers.overlaps),
            slivers.overlaps.max(initial=0.0),
            _LENGTH,
            "pieces that two closed chains both cover; the largest width (2 area / perimeter)",
        ),
        *_turning_rows(areas, chain_lengths, outline),
    ]
    return pd.DataFrame(
        rows, columns=["defect", "count", "length_or_width", "unit", "explanation"]
    ).astype({"count": "int64", "length_or_width": "float64"})


def _turning_rows(
    areas: FloatArray, chain_lengths: FloatArray, outline: Outline
) -> list[tuple[str, int, float, str, str]]:
    """Return the rows that depend on the direction of the chains."""
    low, high = outline.bounding_box()
    flat = FLAT_AREA * max(high[0] - low[0], high[1] - low[1]) ** 2
    left, right = areas > flat, areas < -flat
    return [
        (
            "counter_clockwise_chains",
            int(left.sum()),
            float(chain_lengths[left].sum()),
            _LENGTH,
            "closed chains with positive signed area; their total length",
        ),
        (
            "clockwise_chains",
            int(right.sum()),
            float(chain_lengths[right].sum()),
            _LENGTH,
            "closed chains with negative signed area; their total length",
        ),
        (
            "signed_area",
            int(left.sum() + right.sum()),
            float(areas.sum()),
            _AREA,
            "closed chains with an area; the sum of their signed areas",
        ),
    ]


def _distinct_points(outline: Outline) -> tuple[FloatArray, IntArray]:
    """Return the points in use without repetition, and the segments between them."""
    used, segments = np.unique(outline.segments, return_inverse=True)
    # Adding zero makes -0.0 equal to 0.0 in every bit.
    points, same = np.unique(outline.points[used] + 0.0, axis=0, return_inverse=True)
    return points, same.reshape(-1)[segments.reshape(-1, 2)].astype(np.int64)


def _closed_chains(segments: IntArray, chains: IntArray, n_chains: int) -> BoolArray:
    """Whether the signed boundary of each chain cancels, shape (n_chains,)."""
    n_points = int(segments.max()) + 1
    keys = chains[:, None] * n_points + segments
    key, place = np.unique(keys, return_inverse=True)
    total = np.bincount(place.ravel(), weights=np.tile([-1.0, 1.0], len(segments)))
    is_closed = np.ones(n_chains, dtype=bool)
    is_closed[key[total != 0] // n_points] = False
    return is_closed


def _signed_areas(
    points: FloatArray, segments: IntArray, chains: IntArray, n_chains: int
) -> FloatArray:
    """Return the area each chain winds around counter-clockwise, shape (n_chains,)."""
    centred = points - points.mean(axis=0)
    start, end = centred[segments[:, 0]], centred[segments[:, 1]]
    twice = start[:, 0] * end[:, 1] - start[:, 1] * end[:, 0]
    return np.asarray(np.bincount(chains, weights=0.5 * twice, minlength=n_chains))


def _nearest_distances(ends: FloatArray) -> FloatArray:
    """Return the distance from each point to the nearest other one, shape (n,) or (0,)."""
    if len(ends) < 2:
        return np.empty(0)
    return np.asarray(cKDTree(ends).query(ends, k=2)[0][:, 1])


def _copies(segments: IntArray, lengths: FloatArray) -> dict[str, tuple[int, float]]:
    """Return number and length of surplus copies and of opposite pairs."""
    proper = segments[:, 0] != segments[:, 1]
    undirected = np.sort(segments[proper], axis=1)
    _, first, place = np.unique(undirected, axis=0, return_index=True, return_inverse=True)
    is_forward = segments[proper, 0] == undirected[:, 0]
    forward = np.bincount(place.ravel(), weights=is_forward, minlength=len(first)).astype(int)
    backward = np.bincount(place.ravel(), weights=~is_forward, minlength=len(first)).astype(int)
    length = lengths[proper][first]
    surplus = np.maximum(forward - 1, 0) + np.maximum(backward - 1, 0)
    opposite = np.minimum(forward, backward)
    return {
        "duplicate": (int(surplus.sum()), float((surplus * length).sum())),
        "opposite": (int(opposite.sum()), float((opposite * length).sum())),
    }
