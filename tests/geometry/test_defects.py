import time
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tusqh.geometry.defects import describe_defects
from tusqh.geometry.outline import Outline

ROWS = [
    "segments",
    "chains",
    "zero_length_segments",
    "closed_chains",
    "open_chains",
    "open_ends",
    "duplicate_segments",
    "opposite_segments",
    "overlapping_segments",
    "crossings",
    "touching",
    "end_gaps",
    "border_gaps",
    "border_overlaps",
    "counter_clockwise_chains",
    "clockwise_chains",
    "signed_area",
]
UNMEASURED = {"crossings", "touching"}

SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1), (0, 0)]


def shifted(chain, dx, dy):
    return [(x + dx, y + dy) for x, y in chain]


def outline_of(*chains) -> Outline:
    return Outline.from_chains([np.array(chain, dtype=float) for chain in chains])


def measured(outline: Outline) -> dict[str, tuple[int, float]]:
    table = describe_defects(outline)
    assert list(table.columns) == [
        "defect",
        "count",
        "measure",
        "unit",
        "explanation",
    ]
    assert table["defect"].tolist() == ROWS
    assert set(table["unit"]) == {"model units", "model units^2", "-"}
    return {
        row.defect: (row.count_, row.measure)
        for row in table.rename(columns={"count": "count_"}).itertuples()
    }


def check(outline: Outline, **expected: tuple[int, float]) -> None:
    """Compare the whole table; rows that are not named must be (0, 0)."""
    for defect, (count, length) in measured(outline).items():
        want_count, want_length = expected.pop(defect, (0, 0.0))
        assert count == want_count, defect
        if defect in UNMEASURED:
            assert np.isnan(length), defect
        else:
            assert length == pytest.approx(want_length), defect
    assert not expected


def test_square_has_no_defects():
    check(
        outline_of(SQUARE),
        segments=(4, 4),
        chains=(1, 4),
        closed_chains=(1, 4),
        counter_clockwise_chains=(1, 4),
        signed_area=(1, 1),
    )


def test_square_with_a_missing_side():
    check(
        outline_of(SQUARE[:-1]),
        segments=(3, 3),
        chains=(1, 3),
        open_chains=(1, 3),
        open_ends=(2, 1),
        end_gaps=(2, 1),
    )


def test_doubled_square():
    check(
        outline_of(SQUARE, SQUARE),
        segments=(8, 8),
        chains=(2, 4),
        closed_chains=(2, 8),
        duplicate_segments=(4, 4),
        border_overlaps=(1, 0.5),
        counter_clockwise_chains=(2, 8),
        signed_area=(2, 2),
    )


def test_square_there_and_back():
    check(
        outline_of(SQUARE, SQUARE[::-1]),
        segments=(8, 8),
        chains=(2, 4),
        closed_chains=(2, 8),
        opposite_segments=(4, 4),
        signed_area=(2, 0),
        border_overlaps=(1, 0.5),
        counter_clockwise_chains=(1, 4),
        clockwise_chains=(1, 4),
    )


def test_two_squares_that_share_an_edge():
    check(
        outline_of(SQUARE, shifted(SQUARE, 1, 0)),
        segments=(8, 8),
        chains=(2, 4),
        closed_chains=(2, 8),
        opposite_segments=(1, 1),
        counter_clockwise_chains=(2, 8),
        signed_area=(2, 2),
    )


def test_border_that_gaps_below_and_overlaps_above():
    left = [(0, 0), (1, 0), (1, 2), (0, 2), (0, 0)]
    right = [(1, 0), (2, 0), (2, 2), (1, 2), (0.9, 1.5), (1.1, 0.5), (1, 0)]
    long, short = np.hypot(0.2, 1), np.hypot(0.1, 0.5)
    # Both slivers are triangles with base 1 and height 0.1.
    width = 2 * 0.05 / (1 + long / 2 + short)
    perimeter = 4 + long + 2 * short
    check(
        outline_of(left, right),
        segments=(10, 6 + perimeter),
        chains=(2, max(6, perimeter)),
        closed_chains=(2, 6 + perimeter),
        crossings=(1, np.nan),
        border_gaps=(1, width),
        border_overlaps=(1, width),
        counter_clockwise_chains=(2, 6 + perimeter),
        signed_area=(2, 4),
    )


def test_gap_that_opens_to_the_outside_is_outside():
    check(
        outline_of(SQUARE, shifted(SQUARE, 1.25, 0.5), shifted(SQUARE, -0.75, 0.5)),
        segments=(12, 12),
        chains=(3, 4),
        closed_chains=(3, 12),
        crossings=(2, np.nan),
        border_overlaps=(1, 2 * 0.125 / 1.5),
        counter_clockwise_chains=(3, 12),
        signed_area=(3, 3),
    )


def test_hole_of_one_polygon_is_no_gap_and_its_filling_no_overlap():
    ring = [(-1, -1), (2, -1), (2, 2), (-1, 2), (-1, -1)]
    hole = SQUARE[::-1]
    check(
        outline_of(ring, hole),
        segments=(8, 16),
        chains=(2, 12),
        closed_chains=(2, 16),
        counter_clockwise_chains=(1, 12),
        clockwise_chains=(1, 4),
        signed_area=(2, 8),
    )
    filled = measured(outline_of(ring, hole, SQUARE))
    assert filled["border_gaps"] == filled["border_overlaps"] == (0, 0)
    thin = [(0, 0), (0.9, 0), (0.9, 1), (0, 1), (0, 0)]
    gapped = measured(outline_of(ring, hole, thin))
    assert gapped["border_gaps"] == (1, pytest.approx(2 * 0.1 / 2.2))
    assert gapped["border_overlaps"] == (0, 0)


def test_bow_tie():
    length = 2 * np.hypot(2, 2) + 4
    check(
        outline_of([(0, 0), (2, 2), (2, 0), (0, 2), (0, 0)]),
        segments=(4, length),
        chains=(1, length),
        closed_chains=(1, length),
        crossings=(1, np.nan),
    )


def test_t_junction():
    check(
        outline_of([(0, 0), (2, 0)], [(1, 0), (1, 1)]),
        segments=(2, 3),
        chains=(2, 2),
        open_chains=(2, 3),
        open_ends=(4, 1),
        touching=(1, np.nan),
        end_gaps=(4, 1),
    )


def test_collinear_overlap_and_zero_length():
    check(
        outline_of([(0, 0), (2, 0)], [(3, 0), (1, 0)], [(5, 5), (5, 5)]),
        segments=(3, 4),
        chains=(3, 2),
        zero_length_segments=(1, 0),
        closed_chains=(1, 0),
        open_chains=(2, 4),
        open_ends=(4, 1),
        overlapping_segments=(1, 1),
        end_gaps=(4, 1),
    )


def test_end_points_that_nearly_meet_are_neither_crossing_nor_touching():
    rows = measured(outline_of([(0, 0), (1, 0)], [(1.001, 0), (2, 1)]))
    assert (rows["crossings"][0], rows["touching"][0]) == (0, 0)
    assert rows["end_gaps"] == (4, pytest.approx(np.hypot(0.999, 1)))
    assert rows["open_ends"] == (4, 1)


def test_decimal_coordinates_are_collinear_up_to_rounding():
    base = np.array([350_000.1, 4_200_000.3])
    whole = base + np.array([[0.0, 0.0], [30.3, 60.6]])
    part = base + np.array([[10.1, 20.2], [50.5, 101.0]])
    rows = measured(outline_of(whole, part))
    assert rows["overlapping_segments"] == (1, pytest.approx(np.hypot(20.2, 40.4)))
    assert (rows["crossings"][0], rows["touching"][0]) == (0, 0)


@st.composite
def lattice_chains(draw):
    """Return chains on a small lattice, half of them closed, with every degeneracy."""
    corner = st.tuples(st.integers(0, 4), st.integers(0, 4))
    chains = draw(st.lists(st.lists(corner, min_size=2, max_size=7), min_size=1, max_size=4))
    closing = draw(st.lists(st.booleans(), min_size=len(chains), max_size=len(chains)))
    return [chain + chain[:1] * is_closed for chain, is_closed in zip(chains, closing, strict=True)]


SWAPPED = {
    "counter_clockwise_chains": "clockwise_chains",
    "clockwise_chains": "counter_clockwise_chains",
}


@given(lattice_chains().filter(lambda chains: len({p for c in chains for p in c}) > 1))
def test_reversing_swaps_the_turning_rows_and_changes_nothing_else(chains):
    outline = outline_of(*chains)
    before = measured(outline)
    after = measured(
        Outline(outline.points, outline.segments[:, ::-1], outline.chains, name="reversed")
    )
    for defect, (count, length) in before.items():
        sign = -1 if defect == "signed_area" else 1
        expected = (count, pytest.approx(sign * length, nan_ok=True))
        assert after[SWAPPED.get(defect, defect)] == expected, defect


@given(
    lattice_chains().filter(lambda chains: len({p for c in chains for p in c}) > 1),
    st.randoms(use_true_random=False),
)
def test_order_of_segments_does_not_matter(chains, random):
    outline = outline_of(*chains)
    order = np.arange(outline.n_segments)
    random.shuffle(order)
    shuffled = Outline(outline.points, outline.segments[order], outline.chains[order])
    after = measured(shuffled)
    for defect, (count, length) in measured(outline).items():
        assert after[defect] == (count, pytest.approx(length, nan_ok=True)), defect


@given(lattice_chains().filter(lambda chains: len({p for c in chains for p in c}) > 1))
def test_crossings_agree_with_exact_arithmetic(chains):
    def side(a, b, c):
        return np.sign((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))

    segments = [pair for chain in chains for pair in pairwise(chain)]
    n_crossings = sum(
        side(*s, t[0]) * side(*s, t[1]) < 0 and side(*t, s[0]) * side(*t, s[1]) < 0
        for i, s in enumerate(segments)
        for t in segments[:i]
    )
    assert measured(outline_of(*chains))["crossings"][0] == n_crossings


def test_six_thousand_segments_are_quick():
    rng = np.random.default_rng(3)
    turn = np.linspace(0, 2 * np.pi, 76)
    chains = []
    for _ in range(80):
        radius = 1 + 0.05 * rng.normal(size=76)
        chain = rng.uniform(0, 12, 2) + radius[:, None] * np.column_stack(
            [np.cos(turn), np.sin(turn)]
        )
        chain[-1] = chain[0]
        chains.append(chain)
    outline = outline_of(*chains)
    started = time.perf_counter()
    rows = measured(outline)
    assert outline.n_segments == 6000
    assert rows["border_overlaps"][0] > 10
    assert time.perf_counter() - started < 10
