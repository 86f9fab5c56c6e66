"""In figures of the plane, no text is cut off, and no two texts overlap."""

import itertools

import numpy as np
import pandas as pd
import pytest
from matplotlib import pyplot as plt

from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.figures.antialias import draw_antialias
from tusqh.figures.contaminant import draw_contaminant
from tusqh.figures.field import draw_field
from tusqh.figures.thresholds import draw_thresholds
from tusqh.geometry.outline import Outline
from tusqh.grid import BackgroundGrid
from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.policy import Policy

SHAPES = {"wide": (80, 22), "very wide": (120, 12), "square": (20, 20), "high": (20, 26)}


@pytest.fixture(params=SHAPES)
def fractions(request):
    shape = SHAPES[request.param]
    grid = BackgroundGrid(shape=shape, cell_size=1.0, origin=(0.0, -float(shape[1])))
    values = np.random.default_rng(3).integers(0, 9, [2 * n + 1 for n in shape]) / 8
    return VolumeFractions.from_values(grid, 4, values)


@pytest.fixture
def outline(fractions):
    (x0, y0), (x1, y1) = fractions.grid.origin, fractions.grid.upper
    return Outline.from_chains([np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y0]])], name="half")


def drawn_words(figure):
    """Yield all texts of a drawn figure, of the ticks those within their axis."""
    yield from figure.texts
    for legend in figure.legends:
        yield from legend.get_texts()
    for axes in figure.axes:
        yield axes.title
        for k, axis in enumerate((axes.xaxis, axes.yaxis)):
            yield axis.label
            low, high = sorted(axis.get_view_interval())
            labels = axis.get_ticklabels()
            yield from (text for text in labels if low <= text.get_position()[k] <= high)


def check_words(figure):
    """Check that every text lies within the figure and that no two texts overlap."""
    figure.canvas.draw()
    words = [(text.get_text(), text.get_window_extent()) for text in drawn_words(figure)]
    words = [(text, box) for text, box in words if text]
    assert len(words) > 10
    for text, box in words:
        assert min(box.x0, box.y0) >= -1, text
        assert (box.max <= figure.bbox.max + 1).all(), text
    for (a, box_a), (b, box_b) in itertools.combinations(words, 2):
        assert not box_a.padded(-1).overlaps(box_b.padded(-1)), (a, b)
    plt.close(figure)


def test_fields(fractions, outline):
    check_words(draw_field(fractions, outline, name="plate", unit="mm"))


def test_thresholds(fractions, outline):
    sets = CellSets(fractions)
    check_words(draw_thresholds(sets, outline, [0.5, 0.15, 0.01], name="plate", unit="mm"))


def test_contaminants(fractions):
    mesh = build_mesh(CellSets(fractions).at(0.5), fractions.grid).mesh
    fields = [10.0 ** -np.linspace(0, n, len(mesh.points)) for n in range(6)]
    table = pd.DataFrame({"time_s": np.arange(6) * 5.0, "concentration_unit": "kg/m^2"})
    check_words(draw_contaminant(mesh.points, mesh.cells, fields, table, name="plate", unit="mm"))


def test_pinches_are_those_of_the_tables(fractions):
    """Pinches of removed components and of filled holes are not drawn."""
    policy = {"components": {"min_cells": 5}, "holes": {"min_cells": 3}}
    cells = CellSets(fractions, Policy.from_dict(policy)).at(0.5)
    assert len(cells.features)
    built = build_mesh(cells, fractions.grid, name="plate")
    figure = draw_antialias(fractions, built.mesh, threshold=0.5, unit="mm")
    n_pinches = built.cells.n_contacts
    assert figure.axes[0].get_title().endswith(f"({n_pinches})")
    (dots,) = figure.axes[0].lines
    assert len(dots.get_xdata()) == n_pinches
    plt.close(figure)
