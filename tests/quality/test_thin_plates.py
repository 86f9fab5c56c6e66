"""Plates thinner than the distance of the samples, and plates whose cells all tie."""

import netCDF4
import pytest

import tusqh
from tusqh.errors import SamplingError
from tusqh.meshes.formats import write_mesh


@pytest.fixture
def cases(repository):
    return repository / "tests/cases"


@pytest.mark.parametrize("placement", ["corner", "auto"])
def test_a_plate_between_the_samples_is_refused_with_the_cell_size_that_resolves_it(
    cases, placement
):
    with pytest.raises(
        SamplingError, match=r"one part, 3 across.*samples are 3\.23 apart"
    ) as found:
        tusqh.mesh(
            cases / "37_thin_plates/thin_plate.stl", cells=24, threshold=0.5, placement=placement
        )
    assert "`--cell-size 1.5`" in str(found.value)
    assert "double-sided" not in str(found.value)


def test_a_plate_that_two_of_four_samples_hit_is_three_times_its_exact_volume(cases):
    result = tusqh.mesh(
        cases / "37_thin_plates/plate_on_a_tie.stl", cells=24, threshold=0.5, placement="corner"
    )
    facts = result.report.facts
    assert facts["reference_volume"] == pytest.approx(145_200, rel=1e-9)
    assert facts["volume"] == pytest.approx(443_667, rel=1e-5)
    assert not result.report.is_suitable
    verdict = result.report.verdict.set_index("id")
    assert verdict.loc["volume", "found"] == "3.0556 of the exact volume"
    assert verdict.loc["ties", "holds"] == "warning"
    assert "`--cell-size 1.5`" in verdict.loc["volume", "remedy"]


def test_the_cell_size_of_the_remedy_resolves_a_plate(cases):
    """A strip of the same plate is used, because the whole plate has 43,000 cells."""
    window = ((0, 0, 0), (20, 20, 3))
    result = tusqh.mesh(
        cases / "37_thin_plates/thin_plate.stl", cell_size=1.5, window=window, threshold=0.5
    )
    assert result.report.facts["volume"] == pytest.approx(20 * 20 * 3, rel=0.12)


def test_the_block_of_an_exodus_file_has_the_id_1_and_a_name(cases, tmp_path):
    result = tusqh.mesh(cases / "33_exodus_block_id/s01_plain.stl", cells=8)
    write_mesh(tmp_path / "out.exo", result.mesh)
    with netCDF4.Dataset(tmp_path / "out.exo") as file:
        assert file["eb_prop1"][:].tolist() == [1]
        assert str(netCDF4.chartostring(file["eb_names"][0])).strip("\0") == "solid"
