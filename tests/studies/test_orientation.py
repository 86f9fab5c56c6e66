"""Placements, spreads and stability maps, each compared with a second method."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from shapes import box

from studies.methods.raw_mesh import raw_mesh
from studies.orientation import AS_CONFIGURED, BETTI, SCHEMES, SUB_CELLS, TOUCHING, vary_placement
from studies.placements import Placement, lay_grids, random_placements
from studies.spread import measure_spread, pool_spreads, spread_of
from studies.stability import map_stability, recommend_grid
from tusqh.geometry.outline import Outline
from tusqh.grid import BackgroundGrid
from tusqh.sampling.fractions import sample_fractions
from tusqh.settings.goal import Target
from tusqh.settings.policy import Criteria, Policy
from tusqh.settings.sampling import Sampling

STILL = Placement(np.eye(2), np.zeros(2))


def polygon(*corners):
    return Outline.from_chains([np.array([*corners, corners[0]], dtype=float)])


L_SHAPE = polygon((0, 0), (3, 0), (3, 1), (1, 1), (1, 2), (0, 2))


def test_unturned_grids_have_the_fractions_that_sampling_gives():
    centred = replace(L_SHAPE, points=L_SHAPE.points - [1.5, 1.0])
    for size, fractions in lay_grids(L_SHAPE, STILL, [3, 6, 12]):
        assert fractions.grid.cell_size == pytest.approx(3 / size)
        direct = sample_fractions(
            centred, fractions.grid, sampling=Sampling(samples=fractions.samples)
        )
        assert fractions.samples == 4 * (12 // size)
        np.testing.assert_array_equal(fractions.values, direct.values)


@pytest.mark.parametrize("dim", [2, 3])
def test_turning_and_moving_keeps_the_volume_and_the_topology(dim):
    geometry = polygon((0, 0), (2, 0), (2, 1), (0, 1)) if dim == 2 else box((0, 0, 0), (2, 1, 1))
    for placement in random_placements(dim, 5, seed=1):
        for _, fractions in lay_grids(geometry, placement, [8, 16, 32]):
            assert fractions.volume() == pytest.approx(2.0, rel=0.03)
    table = vary_placement(geometry, Policy(), [0.5], [16, 32], count=5)
    assert (table["betti_0"] == 1).all()
    assert (table[["betti_1", "betti_2"]] == 0).all(axis=None)


def test_random_rotations_are_rotations_and_the_same_each_time():
    for dim in (2, 3):
        first, second = (random_placements(dim, 50, seed=7) for _ in range(2))
        for a, b in zip(first, second, strict=True):
            np.testing.assert_allclose(a.rotation @ a.rotation.T, np.eye(dim), atol=1e-12)
            assert np.linalg.det(a.rotation) == pytest.approx(1)
            assert (a.rotation == b.rotation).all()
            assert (a.offset == b.offset).all()
        # The rotations are uniform, so the image of an axis has no preferred direction.
        assert np.linalg.norm(np.mean([p.rotation[:, 0] for p in first], axis=0)) < 0.3


def test_the_window_turns_with_the_model():
    """Half of a square is outside the window, so the same area remains at every angle."""
    square = polygon((0, 0), (4, 0), (4, 4), (0, 4))
    window = ((2.0, -1.0), (5.0, 5.0))
    for placement in random_placements(2, 6, seed=2):
        ((_, inside),) = lay_grids(square, placement, [48], window=window)
        assert inside.volume() == pytest.approx(8.0, rel=0.02)
        ((_, outside),) = lay_grids(
            square, placement, [48], window=window, sampling=Sampling(domain="outside")
        )
        assert outside.volume() == pytest.approx(18.0 - 8.0, rel=0.02)


def test_raw_betti_numbers_are_those_of_the_mesh_of_the_cells():
    from oracles import betti_by_rank

    table = vary_placement(L_SHAPE, Policy(), [0.3, 0.6], [6], count=4)
    placements = random_placements(2, 4, seed=0)
    for row in table[table["scheme"] == TOUCHING].itertuples():
        ((_, fractions),) = lay_grids(L_SHAPE, placements[row.placement], [6])
        mesh = raw_mesh(fractions.cells >= row.threshold, fractions.grid)
        assert betti_by_rank(mesh.cells) == (row.betti_0, row.betti_1, row.betti_2)


def made_up(raw, decided, policy, cells=8, threshold=0.5):
    """Return a table of placements with given numbers of components."""
    rows = [
        (n, cells, threshold, scheme, value, 0, 0)
        for scheme, values in zip(SCHEMES, (raw, *[decided] * 2, policy), strict=True)
        for n, value in enumerate(values)
    ]
    return pd.DataFrame(rows, columns=["placement", "cells", "threshold", "scheme", *BETTI])


def test_a_spread_that_halves_shrinks_by_half():
    table = made_up([1, 5, 1, 5] * 10, [1, 3, 1, 3] * 10, [1] * 40)
    spread = measure_spread(table, name="a", target=Target(betti_0=1)).set_index("scheme")
    spread = spread.loc[[SUB_CELLS, AS_CONFIGURED]]
    assert spread["raw_spread"].tolist() == [2, 2]
    assert spread["spread"].tolist() == [1, 0]
    assert spread["shrinks"].tolist() == [0.5, 1]
    # Every resampled ratio is exactly one half, because the placements are drawn in pairs.
    assert spread.loc[spread.index[0], ["low", "high"]].tolist() == [0.5, 0.5]
    assert spread["wanted"].tolist() == [0.5, 1]
    assert spread["raw_wanted"].tolist() == [0.5, 0.5]


def test_an_interval_holds_the_value_and_nothing_to_shrink_is_missing():
    rng = np.random.default_rng(0)
    raw, less = rng.integers(0, 9, 50), rng.integers(0, 5, 50)
    spread = measure_spread(made_up(raw, less, less), name="a")
    assert (spread["low"] < spread["shrinks"]).all()
    assert (spread["shrinks"] < spread["high"]).all()
    assert spread["wanted"].isna().all()
    still = measure_spread(made_up([1] * 9, [1] * 9, [1] * 9), name="b")
    assert still[["shrinks", "low", "high"]].isna().all(axis=None)
    tables = {"a": made_up(raw, less, less), "b": made_up([1] * 9, [1] * 9, [1] * 9)}
    pooled = pool_spreads(tables, {"a": 0.5, "b": 0.5})
    assert pooled["models"].tolist() == [2] * 3
    assert pooled["shrinks"].tolist() == spread["shrinks"].tolist()
    # A model that only starts to spread also counts: 1 - (s + 1) / (r + 0).
    tables["b"] = made_up([1] * 8, [1, 3] * 4, [1] * 8)
    pooled = pool_spreads(tables, {"a": 0.5, "b": 0.5}).set_index("scheme")
    raw_sum, less_sum = (float(spread_of(np.array([[n, 0, 0] for n in v]))) for v in (raw, less))
    found = pooled.loc[SUB_CELLS]
    assert found["shrinks"] == pytest.approx(1 - (less_sum + 1) / raw_sum, abs=1e-6)
    assert found["low"] < found["shrinks"] < found["high"]


def test_the_recommended_grid_is_the_coarsest_robust_one():
    coarse = made_up([1, 2] * 10, [1] * 17 + [2, 3, 4], [1] * 17 + [2, 3, 4], cells=8)
    fine = pd.concat(
        made_up([1, 2] * 10, [1] * 19 + [9], [1] * 19 + [9], cells=16, threshold=t)
        for t in (0.2, 0.3, 0.4)
    )
    table = pd.concat([coarse, fine], ignore_index=True)
    stability = map_stability(table, name="a", target=Target(betti_0=1))
    grids = recommend_grid(stability, table).set_index("scheme")
    assert grids.loc[AS_CONFIGURED, ["cells", "threshold", "share", "robust"]].tolist() == [
        *(16, 0.3, 0.95),
        True,
    ]
    assert grids.loc[AS_CONFIGURED, ["topologies", "robust_topologies", "accidents"]].tolist() == [
        2,
        1,
        1,
    ]
    assert not grids.loc[TOUCHING, "robust"]
    assert grids.loc[TOUCHING, "share"] == 0.5


def test_criteria_act_on_the_last_scheme_only():
    table = vary_placement(
        L_SHAPE, Policy(components=Criteria(min_cells=1000)), [0.5], [6], count=2
    )
    betti_0 = table.groupby("scheme")["betti_0"].max()
    assert (betti_0[list(SCHEMES[:-1])] == 1).all()
    assert betti_0[AS_CONFIGURED] == 0


def test_a_grid_laid_by_hand_is_the_grid_of_the_placement():
    turned = Placement(np.array([[0.0, -1.0], [1.0, 0.0]]), np.zeros(2))
    ((_, fractions),) = lay_grids(L_SHAPE, turned, [6])
    upright = polygon((1, -1.5), (1, 1.5), (0, 1.5), (0, -0.5), (-1, -0.5), (-1, -1.5))
    grid = BackgroundGrid(fractions.grid.shape, fractions.grid.cell_size, fractions.grid.origin)
    np.testing.assert_allclose(
        fractions.values,
        sample_fractions(upright, grid, sampling=Sampling(samples=4)).values,
        atol=1e-6,
    )
