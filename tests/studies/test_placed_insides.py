"""Placed models with a made inside keep the ball and the thickness of the finest grid."""

import numpy as np
import pytest
import trimesh

from studies.placements import lay_grids, random_placements
from tusqh.geometry.soup import Soup
from tusqh.settings.sampling import Sampling


@pytest.mark.parametrize("inside", ["envelope", "shell"])
def test_volumes_are_the_same_on_all_grids_and_in_all_places(inside):
    ball = trimesh.creation.icosphere(3)
    soup = Soup(np.array(ball.vertices), np.array(ball.faces), np.zeros(len(ball.faces), dtype=int))
    expected = ball.volume if inside == "envelope" else ball.area * 2 / 16
    for placement in random_placements(3, 2, seed=1):
        for _, fractions in lay_grids(soup, placement, [8, 16], sampling=Sampling(inside=inside)):
            assert fractions.volume() == pytest.approx(expected, rel=0.02)
