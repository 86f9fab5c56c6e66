"""The kinds of defect of an outline."""

from __future__ import annotations

import numpy as np

from tusqh.geometry.defect import AREA, DIMENSIONLESS, LENGTH, NOT_MEASURED, defect
from tusqh.geometry.outline_facts import OutlineFacts
from tusqh.grid import BoolArray, IntArray

Found = tuple[int, float]


@defect(LENGTH, "all segments; their total length")
def _segments(facts: OutlineFacts) -> Found:
    """Count all segments."""
    return len(facts.segments), float(facts.lengths.sum())


@defect(LENGTH, "rings, polylines or paths of the file; the longest one")
def _chains(facts: OutlineFacts) -> Found:
    """Count chains."""
    return facts.n_chains, float(facts.chain_lengths.max())


@defect(LENGTH, "segments that start and end in the same point; their length")
def _zero_length_segments(facts: OutlineFacts) -> Found:
    """Count segments without length."""
    return int((facts.segments[:, 0] == facts.segments[:, 1]).sum()), 0.0


@defect(LENGTH, "chains whose signed boundary cancels; their total length")
def _closed_chains(facts: OutlineFacts) -> Found:
    """Count closed chains."""
    return _chosen(facts, facts.is_closed)


@defect(LENGTH, "chains whose signed boundary does not cancel; their total length")
def _open_chains(facts: OutlineFacts) -> Found:
    """Count open chains."""
    return _chosen(facts, ~facts.is_closed)


@defect(
    DIMENSIONLESS,
    "points where segment ends (+1) and starts (-1) of the whole outline do not cancel; the "
    "largest sum",
)
def _open_ends(facts: OutlineFacts) -> Found:
    """Count points in the boundary of the outline."""
    return int((facts.boundary != 0).sum()), float(np.abs(facts.boundary).max())


@defect(LENGTH, "surplus copies with the same ends and direction; their total length")
def _duplicate_segments(facts: OutlineFacts) -> Found:
    """Count segments that repeat the ends and direction of an earlier one."""
    _, forward, backward = facts.copies
    return _weighted(facts, np.maximum(forward - 1, 0) + np.maximum(backward - 1, 0))


@defect(LENGTH, "pairs with the same ends in opposite directions; their total length")
def _opposite_segments(facts: OutlineFacts) -> Found:
    """Count pairs of segments that cancel."""
    _, forward, backward = facts.copies
    return _weighted(facts, np.minimum(forward, backward))


@defect(LENGTH, "collinear pairs that share a length without being the same; the shared length")
def _overlapping_segments(facts: OutlineFacts) -> Found:
    """Count pairs of segments that overlap in part."""
    return len(facts.pairs.overlaps), float(facts.pairs.shared_lengths.sum())


@defect(DIMENSIONLESS, "pairs of segments whose interiors cross")
def _crossings(facts: OutlineFacts) -> Found:
    """Count crossing pairs."""
    return len(facts.pairs.crossings), NOT_MEASURED


@defect(DIMENSIONLESS, "end points that lie inside another segment, without being collinear")
def _touching(facts: OutlineFacts) -> Found:
    """Count end points on other segments."""
    return len(facts.pairs.touching), NOT_MEASURED


@defect(
    LENGTH, "open ends if there are at least two; the largest distance to the nearest other one"
)
def _end_gaps(facts: OutlineFacts) -> Found:
    """Measure the distances between open ends."""
    return len(facts.end_gaps), float(facts.end_gaps.max(initial=0.0))


@defect(
    LENGTH,
    "bounded pieces between closed chains that none of them covers, enclosed water included; the "
    "largest width (2 area / perimeter)",
)
def _border_gaps(facts: OutlineFacts) -> Found:
    """Count gaps between neighbouring polygons."""
    return len(facts.slivers.gaps), float(facts.slivers.gaps.max(initial=0.0))


@defect(LENGTH, "pieces that two closed chains both cover; the largest width (2 area / perimeter)")
def _border_overlaps(facts: OutlineFacts) -> Found:
    """Count overlaps of neighbouring polygons."""
    return len(facts.slivers.overlaps), float(facts.slivers.overlaps.max(initial=0.0))


@defect(LENGTH, "closed chains with positive signed area; their total length")
def _counter_clockwise_chains(facts: OutlineFacts) -> Found:
    """Count chains that turn left."""
    return _chosen(facts, facts.areas > facts.flat_area)


@defect(LENGTH, "closed chains with negative signed area; their total length")
def _clockwise_chains(facts: OutlineFacts) -> Found:
    """Count chains that turn right."""
    return _chosen(facts, facts.areas < -facts.flat_area)


@defect(AREA, "closed chains with an area; the sum of their signed areas")
def _signed_area(facts: OutlineFacts) -> Found:
    """Sum the signed areas."""
    return int((np.abs(facts.areas) > facts.flat_area).sum()), float(facts.areas.sum())


def _chosen(facts: OutlineFacts, is_chosen: BoolArray) -> Found:
    """Return the number and total length of the chosen chains."""
    return int(is_chosen.sum()), float(facts.chain_lengths[is_chosen].sum())


def _weighted(facts: OutlineFacts, count: IntArray) -> Found:
    """Return the sum of a count per distinct segment, and the total length of all copies."""
    lengths, _, _ = facts.copies
    return int(count.sum()), float((count * lengths).sum())


#: All kinds of defect of an outline, in the order of the table.
OUTLINE_DEFECTS = (
    _segments,
    _chains,
    _zero_length_segments,
    _closed_chains,
    _open_chains,
    _open_ends,
    _duplicate_segments,
    _opposite_segments,
    _overlapping_segments,
    _crossings,
    _touching,
    _end_gaps,
    _border_gaps,
    _border_overlaps,
    _counter_clockwise_chains,
    _clockwise_chains,
    _signed_area,
)
