"""The threshold within an interval, and how far it can move."""

import numpy as np
import pytest
from fields import make_fractions, random_fractions
from shapes import box

import tusqh
from tusqh.antialias.cells import CellSets
from tusqh.sampling.reference import Reference
from tusqh.settings.goal import Goal, Target
from tusqh.threshold.choose import choose_threshold
from tusqh.threshold.plateaus import BETTI, Plateaus, merge_intervals
from tusqh.threshold.within_interval import GOOD, SAFE_DISTANCE, SAFE_SHARE

#: One threshold for all cells, so that its place within an interval matters.
ONE_COMPONENT = Goal(target=Target(betti_0=1), scope="global")


def plateaus_of(fractions, volume):
    return Plateaus(CellSets(fractions), reference=Reference(volume, "the known volume"))


def test_the_threshold_of_a_target_has_the_volume_nearest_to_the_reference():
    """A bar of one component grows by one cell per level; compare it with each volume."""
    cells = np.array([[1.0, 1, 1, 0.9, 0.8, 0.7, 0.6, 0.4, 0.3, 0.2, 0.1]])
    for volume in range(4, 10):
        plateaus = plateaus_of(make_fractions(cells), volume)
        chosen, _ = choose_threshold(plateaus, ONE_COMPONENT)
        assert int((cells >= chosen.threshold).sum()) == volume
        assert (chosen.threshold == 0.5) == (volume == 7)


def test_one_half_is_taken_where_its_volume_is_no_worse_and_only_there():
    cells = np.array([[1.0] * 200 + [0.7, 0.3, 0.2]])
    fractions = make_fractions(cells)
    goal = ONE_COMPONENT
    # The volume of the cells at 1/2 is within 0.5 % of 202.
    assert choose_threshold(plateaus_of(fractions, 202), goal)[0].threshold == 0.5
    assert choose_threshold(plateaus_of(fractions, 180), goal)[0].threshold > 0.7
    assert (
        "at 1/2: its cells have 0.995 of"
        in choose_threshold(plateaus_of(fractions, 202), goal)[0].reason
    )


def test_the_safe_distance_to_the_ends_is_kept_and_no_safe_plateau_has_a_better_volume():
    rng = np.random.default_rng(8)
    n_moved = 0
    for _ in range(5):
        fractions = random_fractions(rng, (5, 6), n_levels=17)
        plateaus = plateaus_of(fractions, rng.uniform(5, 40))
        table = plateaus.table
        for row in merge_intervals(table).itertuples():
            members = table[(table["upper"] <= row.upper) & (table["lower"] >= row.lower)]
            distance = min(SAFE_DISTANCE, SAFE_SHARE * row.width)
            ends = np.minimum(row.upper - members["threshold"], members["threshold"] - row.lower)
            error = (members["volume_ratio"] - 1).abs()[ends >= distance]
            if error.empty:
                continue
            found = abs(row.volume_ratio - 1)
            n_moved += row.threshold != 0.5
            assert min(row.upper - row.threshold, row.threshold - row.lower) >= distance
            assert found <= error.min() or (row.threshold == 0.5 and found <= GOOD)
            cells = plateaus.cell_sets.at(row.threshold)
            assert tuple(cells.predicted) == tuple(getattr(row, name) for name in BETTI)
            assert cells.kept.sum() / plateaus.reference.volume == pytest.approx(row.volume_ratio)
    assert n_moved > 10


def test_an_unknown_volume_leaves_the_middle():
    cells = np.array([[1.0, 0.9, 0.1]])
    chosen, _ = choose_threshold(plateaus_of(make_fractions(cells), 0.0), ONE_COMPONENT)
    assert chosen.threshold == 0.5
    assert "unknown" in chosen.reason


def test_cells_at_exactly_one_half_say_how_far_the_kept_set_holds():
    cells = np.array([[1.0, 1.0, 0.5, 31 / 64, 0.0, 0.75]])
    plateaus = plateaus_of(make_fractions(cells), 4.0)
    chosen, _ = choose_threshold(plateaus, Goal(threshold=0.5))
    assert (chosen.cells_lower, chosen.cells_upper) == (31 / 64, 0.5)
    assert chosen.interval[:3] == (0.0, 0.75, 0.75 - 31 / 64)  # The cells hold down to 31/64.
    assert chosen.extent == (
        "the same topology for 0 < t <= 0.75, the same cells for 0.4844 < t <= 0.5"
    )
    cells[0, 1:3] = 0.5, 1.0  # Now the bar falls apart above 1/2.
    chosen, _ = choose_threshold(plateaus_of(make_fractions(cells), 4.0), Goal(threshold=0.5))
    assert chosen.interval.upper == 0.5
    assert chosen.margin == 1 / 64


def test_a_plate_whose_cells_all_tie_is_not_within_zero():
    plate = box((0, 0, 0), (220, 220, 3))
    result = tusqh.mesh(plate, cells=24, threshold=0.5, placement="corner")
    line = result.report.lines()["threshold"]
    assert line.startswith("0.5: the same topology and the same cells for 0 < t <= 0.5")
    assert result.selection.margin == 0.25
    verdict = result.report.verdict.set_index("id")
    assert verdict.loc["ties", "holds"] == "warning"
