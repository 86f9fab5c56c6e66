import numpy as np
import pytest
from conftest import make_fractions, random_fractions

from tusqh.antialias.resolve import keep_cells, resolve
from tusqh.errors import TopologyError
from tusqh.mesh.betti import betti_by_euler
from tusqh.threshold.select import choose_threshold, predict_plateaus
from tusqh.topology.curves import betti_curves

CELLS = np.array([[1, 1, 1], [0.5, 0.25, 1], [1, 1, 1]])


def predict(fractions, **how):
    plateaus = betti_curves(fractions.values)
    return predict_plateaus(fractions, plateaus, **how)


def test_a_hole_is_found_where_it_lives():
    fractions = make_fractions(CELLS)
    predicted = predict(fractions)
    chosen, candidates = choose_threshold(
        fractions, predicted, target={"betti_0": 1, "betti_1": 1}, name="ring"
    )
    assert (chosen.threshold, chosen.margin) == (0.375, 0.125)
    assert chosen.predicted == (1, 1, 0)
    assert len(candidates) == 1


def test_an_unreachable_target_lists_what_is_reachable():
    fractions = make_fractions(CELLS)
    with pytest.raises(TopologyError) as caught:
        choose_threshold(fractions, predict(fractions), target={"betti_1": 2}, name="ring")
    message = str(caught.value)
    assert "ring: no threshold gives betti_1 = 2" in message
    assert "0.2500 < t <= 0.5000: betti_0 = 1, betti_1 = 1" in message
    assert "nearest: betti_1 = 1" in message


@pytest.mark.parametrize("threshold", [0.0, -1.0, 1.5, float("nan")])
def test_thresholds_out_of_range(threshold):
    fractions = make_fractions(CELLS)
    with pytest.raises(TopologyError, match="threshold is"):
        choose_threshold(fractions, predict(fractions), threshold=threshold)


def test_a_threshold_that_keeps_nothing():
    fractions = make_fractions(CELLS / 2)
    with pytest.raises(TopologyError, match="no cell is left"):
        choose_threshold(fractions, predict(fractions), threshold=0.75)
    with pytest.raises(TopologyError, match="no cell is left"):
        choose_threshold(fractions, predict(fractions), threshold=0.5, min_cells=100)


def test_every_reachable_topology_gives_a_mesh_that_has_it():
    n_meshes = 0
    for seed in range(40):
        rng = np.random.default_rng(seed)
        fractions = random_fractions(rng, (7, 6), n_levels=9)
        how = {"min_cells": int(rng.integers(1, 4))}
        predicted = predict(fractions, **how)
        reachable = predicted[predicted["cells"] > 0][["betti_0", "betti_1"]].drop_duplicates()
        for target in reachable.to_dict("records"):
            chosen, _ = choose_threshold(fractions, predicted, target=target, **how)
            cells = keep_cells(fractions, threshold=chosen.threshold, **how)
            mesh, _ = resolve(cells.kept, cells.decisions, fractions.grid)
            assert betti_by_euler(mesh)._asdict() == {**target, "betti_2": 0}
            n_meshes += 1
    assert n_meshes > 100
