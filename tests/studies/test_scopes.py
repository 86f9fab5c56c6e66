"""Both scopes meet every target, and local changes keep more cells of 1/2."""

import numpy as np
import pandas as pd
import pytest
from shapes import box

from studies.figures.scopes import draw_scopes
from studies.scopes import MOST_TARGETS, compare_scopes, pick_features, pick_targets
from tusqh.grid import BackgroundGrid
from tusqh.pipeline.ingest import read_source
from tusqh.pipeline.sample import sample
from tusqh.pipeline.select import find_plateaus
from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.goal import Target
from tusqh.settings.grid import Grid
from tusqh.threshold.plateaus import BETTI


def fractions_of(cells):
    """Return fractions with empty edges and vertices."""
    values = np.zeros(tuple(2 * n + 1 for n in cells.shape))
    values[(slice(1, None, 2),) * cells.ndim] = cells
    grid = BackgroundGrid(shape=cells.shape, cell_size=1.0, origin=(0.0,) * cells.ndim)
    return VolumeFractions.from_values(grid, 4, values)


def of_source(source, cells, wanted):
    """Return the plateaus and the table of a geometry."""
    geometry = read_source(source, name="model").geometry
    plateaus = find_plateaus(sample(geometry, grid=Grid(cells=cells, placement="corner")))
    return plateaus, compare_scopes(plateaus, geometry, wanted=wanted, name="model")


def two_squares():
    corners = np.array([[0, 0], [4, 0], [4, 4], [0, 4]], dtype=float)
    lines = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    return np.concatenate([corners, corners + np.array([4.3, 0])]), np.concatenate(
        [lines, lines + 4]
    )


def two_boxes():
    first, second = box((0, 0, 0), (4, 3, 3)), box((4.3, 0, 0), (8.3, 3, 3))
    return (
        np.concatenate([first.points, second.points]),
        np.concatenate([first.triangles, second.triangles + len(first.points)]),
    )


@pytest.mark.parametrize("source", [two_squares, two_boxes])
def test_a_gap_costs_a_layer_with_one_threshold_and_only_its_cells_with_local_changes(source):
    wanted = Target(betti_0=2)
    plateaus, table = of_source(source(), 16, wanted)
    assert table["holds"].all()
    assert set(table["scope"]) == {"global", "local"}
    configured = table[table["configured"]].set_index("scope")
    assert set(configured["target"]) == {"betti_0 = 2"}
    base = plateaus.cell_sets.at(0.5)
    assert set(table["base_betti"]) == {str(base.predicted)}
    for scope, row in configured.iterrows():
        threshold = plateaus.cell_sets.at(row["threshold"])
        if scope == "global":
            assert row["cells_changed"] == (threshold.kept != base.kept).sum()
            n_kept = threshold.kept.sum()
            assert row["volume_over_base"] == pytest.approx(n_kept / base.kept.sum())
    saved = configured.loc["local", "cells_saved"]
    changed = configured["cells_changed"]
    assert saved == changed["global"] - changed["local"] > 0
    assert configured.loc["global", "volume_over_base"] < 0.9
    assert configured.loc["local", "volume_over_base"] > 0.9
    boundary = configured["boundary_mean"]
    assert boundary["local"] < boundary["global"]
    labels = [text.get_text() for text in draw_scopes(table).axes[0].get_yticklabels()]
    assert len(labels) == table["target"].nunique()


def test_models_with_few_topologies_get_single_features():
    """A ring keeps its hole at every threshold up to 1/2, and its hole is cut and filled."""
    x, y, z = np.meshgrid(*[np.arange(n) + 0.5 for n in (9, 9, 3)], indexing="ij")
    r = np.hypot(x - 4.5, y - 4.5)
    cells = ((r > 2) & (r < 4) & (z < 9)).astype(float)
    fractions = fractions_of(cells)
    plateaus = find_plateaus(fractions)
    wishes = pick_features(plateaus, 2)
    assert {text.split()[0] for text, _, _ in wishes} == {"cut", "fill"}
    for _, target, goal in wishes:
        assert tuple(target.given().values()) == (1, 0, 0)
        assert goal.features[0].row == 1
    assert pick_features(plateaus, 0) == []


def test_the_configured_target_comes_first_and_those_of_the_base_last():
    rows = [(1, 0, 0, 0.4), (1, 1, 0, 0.3), (2, 0, 0, 0.2), (2, 1, 0, 0.1)]
    predicted = pd.DataFrame(rows, columns=[*BETTI, "width"])
    predicted["upper"] = 1 - predicted["width"].cumsum().shift(fill_value=0.0)
    predicted["lower"] = predicted["upper"] - predicted["width"]
    predicted = predicted.assign(threshold=predicted["upper"], cells=1, volume_ratio=1.0)
    base = tuple(rows[0][:3])
    found = pick_targets(predicted, base, Target(betti_0=1))
    assert found[0] == Target(betti_0=1)
    assert [tuple(t.given().values()) for t in found[1:]] == [(1, 1, 0), (2, 0, 0)]
    assert len(found) == MOST_TARGETS
    found = pick_targets(predicted, base, Target(betti_0=2))
    assert [tuple(t.given().values()) for t in found] == [(2,), (1, 1, 0), (2, 1, 0)]
