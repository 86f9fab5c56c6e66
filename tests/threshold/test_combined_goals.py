"""Combined goals give the right topology and, among its thresholds, the right volume."""

import numpy as np
import pytest
from fields import make_fractions, random_fractions
from shapes import box

import tusqh
from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.errors import ConfigError, TopologyError
from tusqh.sampling.reference import Reference
from tusqh.settings.arguments import from_options
from tusqh.settings.goal import Goal, Target
from tusqh.settings.model import Settings
from tusqh.threshold.choose import choose_threshold
from tusqh.threshold.plateaus import Plateaus


def test_the_mesh_has_the_nearest_volume_of_all_with_the_wanted_topology():
    n_beyond = 0
    for seed in range(6):
        rng = np.random.default_rng(seed)
        fractions = random_fractions(rng, (6, 6), n_levels=9)
        volume = rng.uniform(5, 36)
        plateaus = Plateaus(CellSets(fractions), reference=Reference(volume, "the known volume"))
        table = plateaus.table[plateaus.table["cells"] > 0]
        betti = table[["betti_0", "betti_1"]]
        meshes = [
            build_mesh(plateaus.cell_sets.at(t), fractions.grid).mesh for t in table["threshold"]
        ]
        errors = np.array([abs(mesh.measurement.volume - volume) for mesh in meshes])
        for target in betti.drop_duplicates().to_dict("records"):
            goal = Goal(target=Target(**target), volume="match", scope="global")
            chosen, candidates = choose_threshold(plateaus, goal)
            has_topology = (betti == list(target.values())).all(axis=1).to_numpy()
            found = abs(chosen.resolved.mesh.measurement.volume - volume)
            assert found == pytest.approx(errors[has_topology].min())
            assert chosen.predicted == (*target.values(), 0)
            assert (candidates[["betti_0", "betti_1"]] == list(target.values())).all(axis=None)
            n_beyond += found > errors.min() + 1e-9
    assert n_beyond > 5  # The topology costs volume in many of them.


def test_volume_among_thresholds_with_long_lived_features_only():
    cells = np.ones((7, 12))
    cells[:, 7:], cells[1, 1], cells[4:6, 4:6], cells[3, 9] = 0.0, 0.75, 0.125, 0.5
    plateaus = Plateaus(CellSets(make_fractions(cells)), reference=Reference(50.0, "the volume"))
    chosen, _ = choose_threshold(plateaus, Goal(persistence=0.6, volume="match"))
    assert 0.5 < chosen.threshold <= 0.75
    assert "persistence >= 0.6" in chosen.wanted
    cells[1, 1], cells[3, 9] = 0.5, 0.625
    plateaus = Plateaus(CellSets(make_fractions(cells)))
    with pytest.raises(TopologyError, match="no threshold alone leaves only features"):
        choose_threshold(plateaus, Goal(persistence=0.65, volume="match"))


@pytest.mark.parametrize(
    "given",
    [{"threshold": "0.4"}, {"betti": "1", "persistence": "0.3"}],
    ids=["a threshold", "two that exclude each other"],
)
def test_goals_that_make_no_sense_together_are_refused(given):
    with pytest.raises(ConfigError, match="both are given"):
        from_options(Settings, {**given, "volume": True})


def test_the_command_line_configuration_and_python_combine_them():
    options = from_options(Settings, {"betti": "1,4,0", "volume": True})
    block = Settings.from_dict(
        {"target": {"betti_0": 1, "betti_1": 4, "betti_2": 0}, "volume": "match"}
    )
    assert options.goal == block.goal
    assert options.goal.volume == "match"
    result = tusqh.mesh(box((0, 0, 0), (3.4, 3.4, 3.4)), cells=8, betti=(1, 0, 0), volume="match")
    facts = result.report.facts
    assert result.report.is_met
    assert facts["reference_volume"] == pytest.approx(3.4**3)
    assert facts["volume"] == pytest.approx(3.4**3, rel=0.05)


def test_a_combined_goal_that_misses_the_volume_is_an_error_that_names_both():
    plate = box((0, 0, 0), (220, 220, 3))
    with pytest.raises(TopologyError, match=r"nearest mesh is 3\.05.*with betti_0 = 1") as caught:
        tusqh.mesh(plate, cells=24, betti=(1, 0, 0), volume="match")
    assert "`--cell-size 1.5`" in str(caught.value)
    assert "or `--match-volume`" not in str(caught.value)


def test_a_geometry_without_a_volume_has_none_to_match():
    plateaus = Plateaus(
        CellSets(make_fractions(np.ones((2, 2)))), reference=Reference(0.0, "unknown")
    )
    with pytest.raises(TopologyError, match="encloses nothing"):
        choose_threshold(plateaus, Goal(volume="match"))
