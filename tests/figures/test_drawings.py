"""The check that a figure shows something must itself be able to fail."""

import matplotlib.pyplot as plt
import pytest
from drawings import is_drawn


@pytest.fixture
def axes():
    figure, axes = plt.subplots(figsize=(8, 4), dpi=100)
    yield axes
    plt.close(figure)


def test_an_empty_frame_with_a_title_is_not_drawn(axes, tmp_path):
    axes.set_title("The mesh of a plate")
    axes.set_xlabel("x [m]")
    axes.figure.savefig(tmp_path / "empty.png")
    assert not is_drawn(tmp_path / "empty.png")


def test_a_coloured_area_is_drawn(axes, tmp_path):
    axes.fill([0, 1, 1, 0], [0, 0, 1, 1], color="tab:blue")
    axes.figure.savefig(tmp_path / "full.png")
    assert is_drawn(tmp_path / "full.png")
