"""A geometry that no sample finds is explained."""

import pytest

import tusqh
from tusqh.errors import SamplingError


def test_parts_smaller_than_the_samples_are_named(repository):
    path = repository / "tests/cases/43_small_far_parts/two_islands.geojson"
    with pytest.raises(SamplingError, match=r"2 rings, the largest 0\.5 across") as caught:
        tusqh.mesh(path, cells=48)
    assert all(option in caught.value.remedy for option in ("--cell-size", "--window", "--samples"))


@pytest.mark.parametrize("goal", [{"threshold": 0.5}, {"betti": (1, 0, 0)}, {"volume": "match"}])
@pytest.mark.parametrize("rule", ["average", "clamped"])
def test_an_area_covered_many_times_is_meshed(repository, goal, rule):
    path = repository / "tests/cases/38_covered_many_times/same_square_six_times.geojson"
    result = tusqh.mesh(path, cells=16, rule=rule, **goal)
    assert tuple(result.report.measured) == (1, 0, 0)
    assert result.mesh.points.max(axis=0)[:2] == pytest.approx([4, 2])
    assert len(result.mesh.cells) == 128
