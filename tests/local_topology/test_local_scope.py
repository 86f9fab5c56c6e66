"""Python, command line and configuration ask for the local scope in the same way."""

import json

import numpy as np
import pandas as pd
import pytest
import pyvista
from fields import make_fractions
from typer.testing import CliRunner

import tusqh
from tusqh.antialias.cells import CellSets
from tusqh.certificate import FILE_NAME, check_certificate
from tusqh.cli.app import app
from tusqh.errors import ConfigError
from tusqh.hashing import canonical_json
from tusqh.meshes.export import read_vtu
from tusqh.settings.arguments import from_options, to_words
from tusqh.settings.goal import Goal, Target
from tusqh.settings.model import Settings
from tusqh.threshold.choose import choose_threshold
from tusqh.threshold.plateaus import Plateaus

#: Two squares that are 0.3 apart; a grid of 16 cells joins them at 1/2.
SQUARES = [[0, 0], [4, 0], [4, 4], [0, 4], [4.3, 0], [8.3, 0], [8.3, 4], [4.3, 4]]
LINES = [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4]]
WISH = {"cells": 16, "placement": "corner", "betti": (2, 0)}


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    """Return the result of two squares, and the folder with all of its files."""
    folder = tmp_path_factory.mktemp("squares")
    result = tusqh.mesh((np.array(SQUARES), np.array(LINES)), **WISH, name="squares")
    result.save(folder)
    return result, folder


def failed(folder):
    mesh_file = folder / "mesh.vtu"
    checks = check_certificate(folder / FILE_NAME, mesh_file, read_vtu(mesh_file))
    return [check.id for check in checks if not check.holds]


def test_all_files_state_the_changes(saved):
    result, folder = saved
    assert result.report.measured == (2, 0, 0)
    assert "8 cells in 1 group differ from those of the threshold 0.5" in str(result.report)
    table = pd.read_csv(folder / "changes.csv")
    assert table[["change", "cells"]].values.tolist() == [["left out", 8]]
    certificate = json.loads((folder / FILE_NAME).read_text())
    assert certificate["selection"]["base"] == 0.5
    assert certificate["changes"][0]["cells"] == 8
    facts = json.loads((folder / "facts.json").read_text())
    assert (facts["base"], facts["changed_cells"], facts["changed_groups"]) == (0.5, 8, 1)
    assert not np.any(pyvista.read(folder / "mesh.vtu").cell_data["change"])


def test_the_check_repeats_the_changes(saved, tmp_path):
    _, folder = saved
    done = CliRunner().invoke(app, ["check", str(folder / "mesh.vtu")])
    assert done.exit_code == 0, done.output
    for path in folder.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    stored = json.loads((tmp_path / FILE_NAME).read_text())
    for keys, value, name in (
        (("changes",), [], "certificate_changes"),
        (("selection", "base"), 0.9, "certificate_changes"),
        (("selection", "base"), None, "certificate_cells"),
    ):
        changed = json.loads(canonical_json(stored))
        inner = changed
        for key in keys[:-1]:
            inner = inner[key]
        inner[keys[-1]] = value
        (tmp_path / FILE_NAME).write_text(canonical_json(changed))
        assert name in failed(tmp_path), keys


def test_added_cells_are_marked_in_the_mesh(tmp_path):
    """Two squares that touch in nothing at 1/2 are joined by cells of the gap."""
    points = np.array(SQUARES, dtype=float)
    points[4:, 0] += 0.4
    result = tusqh.mesh((points, np.array(LINES)), **WISH | {"betti": (1, 0)}, name="joined")
    assert result.report.measured == (1, 0, 0)
    (row,) = result.built.changes.to_dict("records")
    assert row["change"] == "added"
    result.write(tmp_path / "mesh.vtu")
    mesh = pyvista.read(tmp_path / "mesh.vtu")
    in_added = np.unique(mesh.cell_data["grid_cell"][mesh.cell_data["change"] == 1])
    cells = result.built.resolved.cells
    assert in_added.tolist() == np.flatnonzero(cells.kept & ~cells.in_base).tolist()


def test_options_arguments_and_configuration_are_the_same():
    options = {"betti": "2,0", "scope": "local", "base": "0.4"}
    block = {"target": {"betti_0": 2, "betti_1": 0}, "scope": "local", "base": 0.4}
    assert from_options(Settings, options) == Settings.from_dict(block)
    assert from_options(Settings, options | {"base": "match"}).goal.base == "match"
    assert to_words(Settings.from_dict(block)) == [
        *("--betti", "2,0,*", "--scope", "local", "--base", "0.4")
    ]


@pytest.mark.parametrize("base", ["0", "1.5", "half"])
def test_a_base_that_is_no_threshold_is_refused(base):
    with pytest.raises(ConfigError, match="option --base"):
        from_options(Settings, {"betti": "1", "scope": "local", "base": base})


def test_the_local_scope_has_no_effect_on_a_threshold():
    geometry = np.array(SQUARES), np.array(LINES)
    results = [
        tusqh.mesh(geometry, cells=16, threshold=0.4, scope=scope, name="squares")
        for scope in ("global", "local")
    ]
    assert np.array_equal(results[0].mesh.cells, results[1].mesh.cells)
    assert "`scope` applies only with `target` or `persistence`" in str(results[1].report)


def test_the_global_scope_takes_one_threshold_for_all_cells(saved):
    geometry = np.array(SQUARES), np.array(LINES)
    result = tusqh.mesh(geometry, **WISH, scope="global", name="squares")
    cells = result.built.resolved.cells
    assert np.array_equal(cells.kept, result.fractions.cells >= result.selection.threshold)
    assert (result.selection.base, len(result.built.changes)) == (None, 0)
    assert "changes" not in result.report.lines()
    local, _ = saved
    one = local.choice.with_one_threshold(local.settings.goal, name="squares")
    assert one == result.selection


def test_a_base_with_the_wanted_topology_is_taken_as_it_is():
    """The widest interval with one component ends at 1; the base lies in a narrow one below it."""
    cells = np.array([[1.0, 1, 0.45, 1], [0.7, 0.48, 0.6, 1]])
    plateaus = Plateaus(CellSets(make_fractions(cells)))
    goal = Goal(target=Target(betti_0=1, betti_1=0), base=0.3)
    chosen, candidates = choose_threshold(plateaus, goal)
    assert (chosen.threshold, chosen.base) == (0.3, 0.3)
    assert "no cell differs" in chosen.reason
    assert np.array_equal(chosen.cells.kept, cells >= 0.3)
    assert candidates["status"].iloc[0] == "chosen"
    assert candidates["lower"].iloc[0] < 0.3 <= candidates["upper"].iloc[0]


def test_persistent_features_with_the_local_scope():
    result = tusqh.mesh(
        (np.array(SQUARES), np.array(LINES)),
        cells=16,
        placement="corner",
        persistence=0.3,
        scope="local",
        base="match",
    )
    assert result.report.is_met
    assert "base" in result.built.facts


@pytest.mark.slow
def test_the_free_parts_of_the_bearing_cost_a_few_hundred_cells(repository):
    result = tusqh.mesh(
        repository / "data_sources/solids/bearings.stl",
        cells=48,
        placement="corner",
        rule="clamped",
        betti=(3, 3, 0),
        scope="local",
    )
    cells = result.built.resolved.cells
    assert result.report.measured == (3, 3, 0)
    assert result.report.is_suitable
    assert cells.n_changes < 400
    assert abs(cells.kept.sum() / cells.in_base.sum() - 1) < 0.03
