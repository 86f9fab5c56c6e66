"""The look of the figures is seaborn's."""

import matplotlib as mpl
import pytest
import seaborn

from tusqh.figures.theme import PALETTE, THEME


def test_the_palette_is_seaborns_for_colour_blind_readers():
    assert list(PALETTE) == list(seaborn.color_palette("colorblind").as_hex())


def test_the_theme_sets_what_seaborn_sets_and_nothing_else():
    with mpl.rc_context():
        mpl.rcdefaults()
        plain = dict(mpl.rcParams)
        seaborn.set_theme(style="ticks", context="paper", palette="colorblind")
        themed = {k: value for k, value in mpl.rcParams.items() if value != plain[k]}
    # Every image sets its own colour map; the colours of lines are compared above.
    del themed["image.cmap"], themed["axes.prop_cycle"]
    ours = {k: value for k, value in THEME.items() if k != "axes.prop_cycle"}
    with mpl.rc_context(ours):
        ours = {k: mpl.rcParams[k] for k in ours}
    numbers = {k for k, value in themed.items() if isinstance(value, float)}
    assert ours.keys() == themed.keys()
    assert {k: ours[k] for k in numbers} == pytest.approx({k: themed[k] for k in numbers})
    assert all(ours[k] == themed[k] for k in themed.keys() - numbers)
