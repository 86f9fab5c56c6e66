"""Facts that determine the defects of an outline, each computed once, when it is needed."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from tusqh.geometry.borders import Slivers, measure_slivers
from tusqh.geometry.outline import Outline
from tusqh.geometry.segment_pairs import SegmentPairs, compare_segments
from tusqh.grid import BoolArray, FloatArray, IntArray

#: The area of a closed chain counts as zero below this fraction of the bounding square, which is
#: the rounding error of the sum that gives the area.
FLAT_AREA = 1e-13


class OutlineFacts:
    """Facts of an outline whose coinciding points are merged.

    Parameters
    ----------
    outline
        The outline.
    """

    def __init__(self, outline: Outline) -> None:
        self.outline = outline
        used, segments = np.unique(outline.segments, return_inverse=True)
        # Adding zero makes -0.0 equal to 0.0 in every bit.
        points, same = np.unique(outline.points[used] + 0.0, axis=0, return_inverse=True)
        #: Distinct points, shape (n, 2).
        self.points: FloatArray = points
        #: Segments between them, shape (m, 2).
        self.segments: IntArray = same.reshape(-1)[segments.reshape(-1, 2)].astype(np.int64)
        numbers, chains = np.unique(outline.chains, return_inverse=True)
        #: Chain of every segment, numbered without gaps, shape (m,).
        self.chains: IntArray = chains
        self.n_chains = len(numbers)

    @cached_property
    def lengths(self) -> FloatArray:
        """Length of every segment, shape (m,)."""
        ends = self.points[self.segments]
        return np.asarray(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1))

    @cached_property
    def chain_lengths(self) -> FloatArray:
        """Length of every chain, shape (n_chains,)."""
        lengths = np.bincount(self.chains, weights=self.lengths, minlength=self.n_chains)
        return lengths.astype(np.float64)

    @cached_property
    def is_closed(self) -> BoolArray:
        """Whether the signed boundary of each chain cancels, shape (n_chains,)."""
        n_points = int(self.segments.max()) + 1
        keys = self.chains[:, None] * n_points + self.segments
        key, place = np.unique(keys, return_inverse=True)
        total = np.bincount(place.ravel(), weights=np.tile([-1.0, 1.0], len(self.segments)))
        is_closed = np.ones(self.n_chains, dtype=bool)
        is_closed[key[total != 0] // n_points] = False
        return is_closed

    @cached_property
    def areas(self) -> FloatArray:
        """Signed area of every closed chain, 0 for open ones, shape (n_chains,)."""
        centred = self.points - self.points.mean(axis=0)
        start, end = centred[self.segments[:, 0]], centred[self.segments[:, 1]]
        twice = start[:, 0] * end[:, 1] - start[:, 1] * end[:, 0]
        areas = np.bincount(self.chains, weights=0.5 * twice, minlength=self.n_chains)
        return np.where(self.is_closed, areas, 0.0)

    @cached_property
    def flat_area(self) -> float:
        """Area below which a chain counts as flat."""
        low, high = self.outline.bounding_box()
        return FLAT_AREA * max(high[0] - low[0], high[1] - low[1]) ** 2

    @cached_property
    def boundary(self) -> IntArray:
        """Ends (+1) and starts (-1) of segments, summed at every point, shape (n,)."""
        starts, ends = self.segments.T
        n_points = len(self.points)
        return np.bincount(ends, minlength=n_points) - np.bincount(starts, minlength=n_points)

    @cached_property
    def end_gaps(self) -> FloatArray:
        """Distance from each open end to the nearest other open end, shape (n,) or (0,)."""
        from scipy.spatial import cKDTree

        ends = self.points[np.flatnonzero(self.boundary)]
        if len(ends) < 2:
            return np.empty(0)
        return np.asarray(cKDTree(ends).query(ends, k=2)[0][:, 1])

    @cached_property
    def copies(self) -> tuple[FloatArray, IntArray, IntArray]:
        """Lengths of distinct undirected segments, and their copies forward and backward."""
        proper = self.segments[:, 0] != self.segments[:, 1]
        undirected = np.sort(self.segments[proper], axis=1)
        _, first, place = np.unique(undirected, axis=0, return_index=True, return_inverse=True)
        is_forward = self.segments[proper, 0] == undirected[:, 0]
        n, place = len(first), place.ravel()
        forward = np.bincount(place, weights=is_forward, minlength=n).astype(np.int64)
        backward = np.bincount(place, weights=~is_forward, minlength=n).astype(np.int64)
        return self.lengths[proper][first], forward, backward

    @cached_property
    def pairs(self) -> SegmentPairs:
        """Pairs of segments that cross, touch or overlap."""
        return compare_segments(self.points, self.segments)

    @cached_property
    def slivers(self) -> Slivers:
        """Gaps and overlaps between closed chains."""
        in_closed = self.is_closed[self.chains]
        # Rounding does not decide on which side a chain without area turns.
        areas = np.where(np.abs(self.areas) > self.flat_area, self.areas, 0.0)
        return measure_slivers(
            self.points,
            self.segments[in_closed],
            (np.cumsum(self.is_closed) - 1)[self.chains[in_closed]],
            areas=areas[self.is_closed],
        )
