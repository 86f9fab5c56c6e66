import pytest

from tusqh.errors import SamplingError
from tusqh.geometry.outline import Outline
from tusqh.grid import BackgroundGrid
from tusqh.sampling.layout import lay_grid


def test_a_grid_lies_over_the_window_or_the_bounding_box(square):
    window = ((0.0, 0.0), (2.0, 1.0))
    assert lay_grid(square, window, cells=4).shape == (4, 2)
    assert lay_grid(square, None, cells=[5, 5]).shape == (5, 5)
    assert lay_grid(square, None, cell_size=0.25).shape == (4, 4)
    assert lay_grid(square, None, cell_size=0.3).shape == (4, 4)
    assert lay_grid(square, None, cell_size=0.3).origin == pytest.approx((-0.1, -0.1))


def test_a_flat_box_is_refused():
    line = Outline.from_chains([[[0.0, 0.0], [1.0, 0.0]]], name="line")
    with pytest.raises(SamplingError, match="zero extent"):
        lay_grid(line, None, cells=4)


@pytest.mark.parametrize(
    "size", [{"cells": 0}, {"cell_size": -1.0}, {"cells": 3, "cell_size": 1}, {}]
)
def test_sizes_without_meaning_are_refused(square, size):
    with pytest.raises(SamplingError):
        lay_grid(square, None, **size)


def test_a_grid_survives_json():
    grid = BackgroundGrid(shape=(3, 4), cell_size=0.1, origin=(0.3, -7.0))
    assert BackgroundGrid.from_dict(grid.to_dict()) == grid
    assert grid.padded().shape == (5, 6)
