"""The tables of the benchmarks, and the comparison with other programs."""

import numpy as np
import pandas as pd
from scipy import ndimage

from benchmarks.pipeline import COLUMNS, RESULT, to_markdown, with_others
from benchmarks.topology import curves_cubical, white_noise


def test_cases_that_are_not_measured_again_keep_their_rows(tmp_path):
    def table(cells, seconds):
        stages = ["reading", "total"]
        rows = {"model": "bunny", "cells": cells, "goal": "a", "stage": stages, "seconds": seconds}
        return pd.DataFrame(rows)

    path = tmp_path / "pipeline.csv"
    pd.concat([table(64, 1.0), table(256, 9.0)]).to_csv(path, index=False)
    found = with_others(table(64, 2.0), path)
    assert found["cells"].tolist() == [64, 64, 256, 256]
    assert found["seconds"].tolist() == [2, 2, 9, 9]
    assert with_others(table(64, 2.0), tmp_path / "none.csv").equals(table(64, 2.0))


def test_gudhi_counts_the_components_of_cells_that_share_faces():
    values = white_noise(5)
    cells = values[1::2, 1::2, 1::2]
    components = [ndimage.label(cells >= level)[1] for level in np.unique(cells)]
    counts = curves_cubical(values)
    assert counts[0].tolist() == components
    assert len(counts) == 3


def test_the_committed_table_has_the_columns_and_every_stage(repository):
    table = pd.read_csv(repository / RESULT)
    assert table.columns.tolist() == COLUMNS
    for _, case in table.groupby(["model", "cells", "goal"]):
        stages = case.set_index("stage")["seconds"]
        assert stages.index[-1] == "total"
        of_mesh = stages.iloc[: stages.index.get_loc("report")]
        assert 0.9 * stages["total"] < of_mesh.sum() < stages["total"] + 0.01


def test_the_readme_quotes_the_committed_table(repository):
    table = pd.read_csv(repository / RESULT)
    assert to_markdown(table) in (repository / "README.md").read_text()
