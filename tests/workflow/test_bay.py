"""The real model: every threshold of the sweep, and every topology that can be asked for."""

import pytest

from tusqh.antialias.resolve import keep_cells, resolve
from tusqh.geometry.read import read_outline
from tusqh.mesh.betti import betti_by_boundary
from tusqh.sampling.fractions import sample_fractions
from tusqh.sampling.layout import lay_grid
from tusqh.tables import VERIFICATION_COLUMNS, verification_row
from tusqh.threshold.select import choose_threshold, predict_plateaus
from tusqh.topology.curves import betti_curves

WINDOW = ((250000.0, 4075000.0), (490000.0, 4391000.0))


@pytest.fixture(scope="module")
def fractions(repository):
    outline = read_outline(repository / "data_sources/chesapeake/counties.geojson")
    grid = lay_grid(outline, WINDOW, cells=[60, 79])
    return sample_fractions(outline, grid, domain="outside", window=WINDOW)


@pytest.mark.parametrize("min_cells", [1, 4])
@pytest.mark.parametrize("threshold", [0.9, 0.75, 0.5, 0.25, 0.15, 0.05, 0.01])
def test_predicted_topology_is_measured_topology(fractions, threshold, min_cells):
    cells = keep_cells(fractions, threshold=threshold, min_cells=min_cells)
    mesh, _ = resolve(cells.kept, cells.decisions, fractions.grid, name="chesapeake")
    row = verification_row(mesh, cells, grid=fractions.grid.label, threshold=threshold)
    assert list(row) == VERIFICATION_COLUMNS
    assert row["holds"]
    assert row["grid"] == "60x79"


def test_at_least_six_topologies_can_be_asked_for(fractions):
    plateaus = betti_curves(fractions.values)
    predicted = predict_plateaus(fractions, plateaus, min_cells=4)
    targets = predicted[["betti_0", "betti_1"]].drop_duplicates().to_dict("records")
    assert len(targets) >= 6
    for target in targets:
        chosen, _ = choose_threshold(fractions, predicted, target=target, min_cells=4)
        cells = keep_cells(fractions, threshold=chosen.threshold, min_cells=4)
        mesh, _ = resolve(cells.kept, cells.decisions, fractions.grid)
        assert betti_by_boundary(mesh)._asdict() == {**target, "betti_2": 0}
