"""The windows of the theorem agree with the numbers it states and with exhaustive patches."""

import math

import numpy as np
import pytest

from studies.contradictions import list_contradictions
from studies.directions import normals_of, plane_normals, rotations
from studies.gap_kernels import RULES, critical_width
from studies.theorem import (
    crossing_widths,
    measure,
    tabulate_orientations,
    tabulate_sweep,
    tabulate_windows,
)

OFFSETS = np.arange(8) / 8


@pytest.fixture(scope="module")
def exact_plane():
    return measure(rotations(5.0), OFFSETS, 0)


def ends(windows, end):
    return windows[windows["end"] == end].set_index("scheme")["found"]


def test_exact_windows_in_the_plane(exact_plane):
    windows = tabulate_windows(exact_plane, 0)
    for rule in RULES:
        assert ends(windows, "lower")[rule] == pytest.approx(math.sqrt(2) - 1, abs=1e-6)
    expected = dict(zip(RULES, (math.sqrt(2), 1, 1, math.sqrt(0.5)), strict=True))
    assert ends(windows, "upper").to_dict() == pytest.approx(expected, abs=1e-6)


def test_exact_windows_in_space():
    windows = tabulate_windows(measure(plane_normals(2), np.arange(4) / 4, 0), 0)
    # For uniform x, y, z in [-1/2, 1/2] the median m of |x + y + z| solves this cubic equation:
    # m**3 / 3 - 3 m / 4 + 1 / 4 = 0.
    m = min(r.real for r in np.roots([1 / 3, 0, -3 / 4, 1 / 4]) if 0 < r.real < 1)
    assert ends(windows, "lower")["faces"] == pytest.approx(2 * m / math.sqrt(3), abs=1e-6)
    expected = dict(zip(RULES, (math.sqrt(3), 1, 1, math.sqrt(3) / 2), strict=True))
    assert ends(windows, "upper").to_dict() == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("places", [rotations(9.0), plane_normals(3)], ids=["plane", "space"])
def test_closed_forms_are_what_patches_have(places):
    """No patch opens later than its longest step, and some offset reaches it."""
    table = tabulate_orientations(measure(places, OFFSETS, 0), 0)
    assert (table["largest_opening"] <= table["crossing_width"] + 1e-9).all()
    short = (table["crossing_width"] - table["largest_opening"]).groupby(table["scheme"]).max()
    # At a general rotation an offset comes close to that of the longest diagonal step.
    assert short[["touching", "sub-cells"]].max() < 0.03
    assert short[["faces", "filtration"]].max() < 1e-9
    assert (table["smallest_closing"] >= table["middle_width"] - 1e-9).all()


def test_orientation_cannot_be_resolved_below_half_a_cell():
    """A diagonal gap can be open although an axis-aligned gap of its width is always closed."""
    along, across = normals_of(np.array([[0.0], [45.0]]))
    assert critical_width(0.0, along, np.empty(0)) == pytest.approx(0.5)
    assert critical_width(0.0, across, np.empty(0)) == pytest.approx(math.sqrt(2) - 1)


def test_the_sweep_counts_every_offset_once_and_finds_the_contradictions(exact_plane):
    widths = np.array([0.4, 0.45, 0.6, 0.75, 1.0, 1.2])
    sweep = tabulate_sweep(exact_plane, widths, 0)
    assert (sweep[["closed", "open", "mixed"]].sum(axis=1) == len(OFFSETS)).all()
    assert len(sweep) == 4 * len(widths) * len(exact_plane.places)
    found = list_contradictions(sweep)
    assert set(found["scheme"]) == {"touching", "filtration"}
    touching = found[found["scheme"] == "touching"]
    assert (touching["width"] == 1.2).all()
    at_axes = found[(found["scheme"] == "filtration") & (found["degrees"] == 0)]
    assert sorted(at_axes["width"]) == [0.75, 1.0]  # The offset decides.
    assert found["why"].str.contains("across the gap").all()


def test_samples_move_the_axis_aligned_end_by_one_row_of_them():
    for samples in (2, 4, 8):
        widths = measure(np.array([[0.0]]), OFFSETS, samples)
        assert widths.opening[0, :, 1].max() == pytest.approx(1 + 1 / samples)


def test_the_tie_at_the_upper_end_with_sub_cells():
    """At exactly sqrt(2)/2 a cell and a vertex, each just half full, join across the gap."""
    widths = measure(np.array([[45.0]]), np.array([0.5]), 0)
    assert widths.opening[0, 0, RULES.index("sub-cells")] == pytest.approx(math.sqrt(0.5))
    step = crossing_widths("sub-cells", normals_of(np.array([[45.0]])))[0]
    assert step == pytest.approx(math.sqrt(0.5))
