import json

import numpy as np
import pandas as pd
import pytest
from fields import make_fractions, random_fractions

from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.errors import TopologyError
from tusqh.local_topology.move import approach
from tusqh.meshes.betti import betti_by_boundary, betti_by_euler
from tusqh.meshes.measure import Measurement
from tusqh.settings.goal import Goal, Range, Target
from tusqh.settings.policy import Criteria, Policy
from tusqh.threshold import plateaus
from tusqh.threshold.choose import choose_threshold
from tusqh.threshold.goals import distances
from tusqh.threshold.plateaus import Plateaus, merge_intervals
from tusqh.threshold.selection import Selection

CELLS = np.array([[1, 1, 1], [0.5, 0.25, 1], [1, 1, 1]])


def choose(fractions, policy=None, **wanted):
    if "target" in wanted:
        wanted["target"] = Target.from_dict(wanted["target"])
    return choose_threshold(Plateaus(CellSets(fractions, policy)), Goal(**wanted), name="ring")


def mesh_of(fractions, chosen):
    """Return the workflow's mesh, made from the threshold and policy of the selection."""
    cell_sets = approach(CellSets(fractions, chosen.policy), chosen.base)
    cells = cell_sets.at(chosen.threshold)
    assert cells.predicted == chosen.predicted
    return build_mesh(cells, fractions.grid).mesh


def test_a_hole_is_found_where_it_lives():
    wish = {"target": {"betti_0": 1, "betti_1": 1}, "scope": "global"}
    chosen, candidates = choose(make_fractions(CELLS), **wish)
    assert (chosen.threshold, chosen.margin) == (0.375, 0.125)
    assert (chosen.cells_lower, chosen.cells_upper) == (0.25, 0.5)
    assert chosen.interval == (0.25, 0.5, 0.125, 0)
    assert chosen.predicted == chosen.raw == (1, 1, 0)
    assert candidates["status"].tolist() == ["chosen"]


@pytest.mark.parametrize(
    ("wanted", "holes"),
    [(1, 1), ([0, 5], 0), ({"min": 1}, 1), ({"max": 0}, 0), ({"min": 1, "max": 3}, 1)],
)
def test_targets_may_be_numbers_lists_and_ranges(wanted, holes):
    chosen, _ = choose(make_fractions(CELLS), target={"betti_1": wanted})
    assert chosen.predicted.betti_1 == holes


def test_an_unreachable_target_lists_what_is_reachable():
    with pytest.raises(TopologyError) as caught:
        choose(make_fractions(CELLS), target={"betti_1": 2})
    message = str(caught.value)
    assert "ring: no threshold gives betti_1 = 2" in message
    assert "0.2500 < t <= 0.5000: betti_0 = 1, betti_1 = 1" in message
    assert message.index("betti_1 = 1") > message.index("the nearest first")


@pytest.mark.parametrize("threshold", [0.0, -1.0, 1.5, float("nan")])
def test_thresholds_out_of_range(threshold):
    with pytest.raises(TopologyError, match="threshold is"):
        choose(make_fractions(CELLS), threshold=threshold)


def test_a_fixed_threshold_says_how_far_it_can_move():
    chosen, candidates = choose(make_fractions(CELLS), threshold=0.3)
    assert chosen.interval[:2] == (0.25, 0.5)
    assert chosen.margin == 0.125  # The margin of the kept cells is the same in the whole interval.
    assert len(candidates) == 0


def test_a_threshold_that_keeps_nothing():
    fractions = make_fractions(CELLS / 2)
    with pytest.raises(TopologyError, match="no cell is left"):
        choose(fractions, threshold=0.75)
    with pytest.raises(TopologyError, match="no cell is left"):
        choose(fractions, Policy(components=Criteria(min_cells=100)), threshold=0.5)
    with pytest.raises(TopologyError, match="no cell is left"):
        choose(fractions, Policy(components=Criteria(min_cells=100)), volume="match")


def test_a_measurement_that_disagrees_sends_the_loop_to_the_next_candidate(monkeypatch):
    """Two intervals have one component; the mesh of the wider one is made to disagree."""
    cells = np.array([[1.0, 0.5, 0.75, 0.125]])
    fractions = make_fractions(cells)
    first, ranked = choose(fractions, target={"betti_0": 1})
    assert ranked["status"].tolist() == ["chosen", "not tried"]
    real = Measurement.has_topology
    seen = []

    def disagree_once(measured, predicted):
        seen.append(predicted)
        return len(seen) > 1 and real(measured, predicted)

    monkeypatch.setattr(Measurement, "has_topology", disagree_once)
    second, ranked = choose(fractions, target={"betti_0": 1})
    assert ranked["status"].tolist() == ["measurement disagrees", "chosen"]
    assert second.threshold == ranked["threshold"][1] != first.threshold
    monkeypatch.setattr(Measurement, "has_topology", lambda measured, predicted: False)
    with pytest.raises(TopologyError, match="no threshold gives"):
        choose(fractions, target={"betti_0": 1})
    with pytest.raises(TopologyError, match="no mesh near the wanted volume"):
        choose(fractions, volume="match")


def test_every_reachable_topology_gives_a_mesh_that_has_it():
    n_meshes = 0
    for seed in range(40):
        rng = np.random.default_rng(seed)
        fractions = random_fractions(rng, (7, 6), n_levels=9)
        policy = Policy(
            bridges=("none", "forest", "all")[seed % 3],
            components=Criteria(min_cells=int(rng.integers(1, 4))),
        )
        cell_sets = CellSets(fractions, policy)
        of_field = Plateaus(cell_sets)
        predicted = of_field.table
        reachable = predicted[predicted["cells"] > 0][["betti_0", "betti_1"]].drop_duplicates()
        for target in reachable.to_dict("records"):
            chosen, _ = choose_threshold(of_field, Goal(target=Target(**target)))
            mesh = mesh_of(fractions, chosen)
            assert betti_by_euler(mesh)._asdict() == {**target, "betti_2": 0}
            n_meshes += 1
    assert n_meshes > 100


def test_every_threshold_of_an_interval_has_its_topology():
    for seed in range(20):
        fractions = random_fractions(np.random.default_rng(seed), (6, 7), n_levels=9)
        cell_sets = CellSets(fractions)
        intervals = merge_intervals(Plateaus(cell_sets).table)
        for row in intervals.itertuples():
            assert row.unexamined == 0
            for t in np.linspace(row.upper, row.lower, 6)[:-1]:
                assert cell_sets.at(t).predicted == (row.betti_0, row.betti_1, row.betti_2)


def test_of_too_many_plateaus_some_are_looked_at_and_the_rest_is_reported(monkeypatch):
    monkeypatch.setattr(plateaus, "MIN_PLATEAUS", 10)
    monkeypatch.setattr(plateaus, "MAX_PLATEAUS", 10)
    rng = np.random.default_rng(3)
    fractions = make_fractions(rng.random((6, 6)), rng.random((7, 7)))
    cell_sets = CellSets(fractions)
    predicted = Plateaus(cell_sets).table
    assert 5 <= len(predicted) <= 10 < len(cell_sets.distinct_fractions)
    assert (np.diff(predicted["threshold"]) < 0).all()
    intervals = merge_intervals(predicted)
    assert intervals["unexamined"].sum() > 0
    examined = predicted.loc[predicted["cells"] > 0, "width"].sum()
    total = intervals["width"].sum()
    assert examined + intervals["unexamined"].sum() == pytest.approx(total)


# A large plate with a deep hole, a shallow one, and a speck beside it: the shallow hole lives
# from 1 to 0.75 and the speck from 0.5 to 0, so no threshold shows the deep hole alone.
PLATE = np.ones((7, 12))
PLATE[:, 7:] = 0.0
PLATE[1, 1] = 0.75
PLATE[4:6, 4:6] = 0.125
PLATE[3, 9] = 0.5


def test_persistence_takes_a_threshold_where_one_does_it():
    chosen, _ = choose(make_fractions(PLATE), persistence=0.4)
    assert chosen.predicted in [(1, 1, 0), (2, 1, 0), (1, 0, 0), (2, 0, 0)]
    assert chosen.policy.components.min_persistence == 0
    chosen, candidates = choose(make_fractions(PLATE), persistence=0.6)
    assert "nothing shorter-lived" in chosen.reason
    assert 0.5 < chosen.threshold <= 0.75  # This is below the shallow hole and above the speck.
    assert chosen.predicted == (1, 1, 0)
    assert betti_by_boundary(mesh_of(make_fractions(PLATE), chosen)) == (1, 1, 0)
    assert candidates["status"].tolist().count("chosen") == 1


def test_persistence_removes_and_fills_exactly_the_short_lived_where_no_threshold_does():
    cells = PLATE.copy()
    cells[1, 1] = 0.5  # Now the ranges of the shallow hole and of the speck do not overlap ...
    cells[3, 9] = 0.625  # ... but one of the two is present at every threshold.
    fractions = make_fractions(cells)
    chosen, _ = choose(fractions, persistence=0.65)
    assert "no threshold does it alone" in chosen.reason
    assert chosen.predicted == (1, 1, 0)
    settings = chosen.policy
    assert settings.components.min_persistence == settings.holes.min_persistence == 0.65
    dropped = CellSets(fractions, settings).at(chosen.threshold).features
    assert len(dropped) == 1
    assert (dropped["persistence"] < 0.65).all()
    mesh = mesh_of(fractions, chosen)
    assert betti_by_boundary(mesh) == betti_by_euler(mesh) == (1, 1, 0)


def test_persistence_never_chooses_an_empty_mesh():
    cells = np.where(CELLS == 1, 0.5, 0.25)  # No class lives longer than half of all thresholds.
    with pytest.raises(TopologyError, match="nor removing and filling features leaves"):
        choose(make_fractions(cells), persistence=0.75)
    n_chosen = 0
    for seed in range(20):
        fractions = random_fractions(np.random.default_rng(seed), (4, 4), n_levels=5)
        try:
            chosen, _ = choose(fractions, persistence=1.0)
        except TopologyError:
            continue
        n_chosen += 1
        assert chosen.predicted.betti_0 > 0
    assert n_chosen > 5


def test_no_number_lies_in_an_empty_range():
    rows = pd.DataFrame({"betti_0": np.arange(6)})
    for low, high in ((3, 1), (2, 1), (5, 0)):
        assert (distances(rows, Target(betti_0=Range(min=low, max=high))) > 0).all()
    assert distances(rows, Target(betti_0=Range(min=2, max=3))).tolist() == [2, 1, 0, 0, 1, 2]


def test_persistence_on_random_fields_is_verified_by_measurement():
    n_cut = n_refused = 0
    for seed in range(60):
        fractions = random_fractions(np.random.default_rng(seed), (8, 8), n_levels=9)
        policy = Policy(bridges="none")
        try:
            chosen, _ = choose(fractions, policy, persistence=0.5)
        except TopologyError:
            n_refused += 1
            continue
        mesh = mesh_of(fractions, chosen)
        pairs = CellSets(fractions).topology.pairs
        long = pairs[pairs["persistence"] >= 0.5]
        alive = (long["birth"] >= chosen.threshold) & (long["death"] < chosen.threshold)
        if "no threshold does it alone" in chosen.reason:
            n_cut += 1
            expected = [int((alive & (long["dimension"] == k)).sum()) for k in range(2)]
            assert [*expected, 0] == list(betti_by_boundary(mesh))
    assert n_cut > 5
    assert n_refused < 30


def test_keep_the_longest_reports_the_thresholds_that_need_no_filling():
    policy = Policy(holes=Criteria(keep=1), components=Criteria(keep=1))
    chosen, _ = choose(make_fractions(PLATE), policy, threshold=0.9)
    assert chosen.predicted == (1, 1, 0)
    assert "0.5 < t <= 0.75" in chosen.without_features
    mesh = mesh_of(make_fractions(PLATE), chosen)
    assert betti_by_boundary(mesh) == (1, 1, 0)


def test_volume_is_matched_by_measured_meshes():
    for seed in range(10):
        fractions = random_fractions(np.random.default_rng(seed), (9, 9), n_levels=17)
        chosen, candidates = choose(fractions, volume="match")
        errors = candidates["volume_error"].abs()
        best = candidates[candidates["status"] == "chosen"].iloc[0]
        assert abs(best["volume_error"]) == errors.min()
        assert best["threshold"] == chosen.threshold
        # A quarter of all cells per level is the best that any threshold could promise.
        assert errors.min() < 0.25


def test_a_selection_survives_json():
    policy = Policy(holes=Criteria(keep=1), components=Criteria(keep=1))
    chosen, _ = choose(make_fractions(PLATE), policy, threshold=0.9)
    again = Selection.from_dict(json.loads(json.dumps(chosen.to_dict())))
    assert again == chosen
    assert again.without_features == chosen.without_features != ""
    assert again.resolved is None


def test_a_given_threshold_examines_its_own_interval_only(monkeypatch):
    rng = np.random.default_rng(11)
    for limit in (1000, 12):
        monkeypatch.setattr(plateaus, "MIN_PLATEAUS", limit)
        monkeypatch.setattr(plateaus, "MAX_PLATEAUS", limit)
        for _ in range(10):
            fractions = make_fractions(rng.random((4, 4)), rng.random((5, 5)))
            examined = Plateaus(CellSets(fractions))
            whole = Plateaus(CellSets(fractions)).table
            intervals = merge_intervals(whole)
            for threshold in (0.31, 0.47, 0.5, 0.62):
                cells = examined.cell_sets.at(threshold)
                holds = (intervals["lower"] < threshold) & (threshold <= intervals["upper"])
                holds &= (intervals[plateaus.BETTI].to_numpy() == cells.predicted).all(axis=1)
                chosen, candidates = choose_threshold(examined, Goal(threshold=threshold))
                assert len(candidates) == 0
                assert chosen.resolved is None
                if holds.any():
                    row = intervals[holds].iloc[0]
                    assert chosen.interval[:2] == (row["lower"], row["upper"])
                    assert chosen.interval.unexamined == row["unexamined"]
            assert limit < 1000 or len(examined._rows) < len(examined)


def test_a_selection_carries_the_mesh_that_verified_it():
    for wanted in ({"target": {"betti_1": 1}}, {"persistence": 0.2}, {"volume": "match"}):
        fractions = make_fractions(CELLS)
        chosen, _ = choose(fractions, **wanted)
        assert chosen.resolved.mesh.measurement.has_topology(chosen.predicted)
        assert np.array_equal(chosen.resolved.mesh.points, mesh_of(fractions, chosen).points)
        assert "resolved" not in chosen.to_dict()
