"""`tusqh inspect` lists few intervals and the useful ones first."""

import sys

import numpy as np
import pandas as pd
import pytest
from fields import random_fractions

from tusqh.antialias.cells import CellSets
from tusqh.cli.app import main
from tusqh.cli.inspect import _list_topologies
from tusqh.threshold.plateaus import Plateaus, merge_intervals


def noise(seed):
    """Return every plateau of a noisy field, which has many intervals."""
    rng = np.random.default_rng(seed)
    return Plateaus(CellSets(random_fractions(rng, (9, 9), n_levels=65))).table


@pytest.mark.parametrize("base", [0.03, 0.5, 0.97])
def test_at_most_ten_intervals_with_that_of_the_base_threshold_among_them(base):
    table = noise(3)
    n_intervals = len(merge_intervals(table))
    shown, n_more = _list_topologies(table, base, every=False)
    assert n_intervals > 12
    assert (len(shown), n_more) == (10, n_intervals - 10)
    marked = shown[shown["at"] != ""]
    assert len(marked) == 1
    assert (marked["lower <"] < base).all()
    assert (marked["t <= upper"] >= base).all()
    every, none = _list_topologies(table, base, every=True)
    assert (len(every), none) == (n_intervals, 0)


def test_a_wide_interval_with_four_cells_is_not_first():
    table = pd.DataFrame({"upper": [1.0, 0.35], "lower": [0.35, 0.0], "width": [0.65, 0.35]})
    table = table.assign(threshold=[0.6, 0.2], cells=[4, 390], volume_ratio=[0.01, 0.98])
    table = table.assign(betti_0=[4, 1], betti_1=0, betti_2=0)
    shown, _ = _list_topologies(table, 0.5, every=False)
    assert shown["cells"].tolist() == [390, 4]
    assert shown["volume"].tolist() == [0.98, 0.01]


def test_the_base_threshold_is_an_option(tmp_path, repository, capfd, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tusqh.cli.app.catch_signals", lambda: None)
    plate = repository / "tests/cases/37_thin_plates/plate_on_a_tie.stl"
    words = ["tusqh", "inspect", str(plate), "--cells", "24", "--threshold", "0.2"]
    monkeypatch.setattr(sys, "argv", [*words, "--placement", "corner"])
    with pytest.raises(SystemExit):
        main()
    out = capfd.readouterr().out
    assert "at: where t = 0.2 lies" in out
    assert "the exact volume" in out
