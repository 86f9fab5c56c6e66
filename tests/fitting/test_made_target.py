"""Meshes of envelopes and shells are fitted to the touched surface and to its offsets."""

import numpy as np
import pytest
import trimesh

import tusqh
from tusqh.pipeline.recheck import recheck
from tusqh.pipeline.recheck_fit import recheck_fit


def circle(n=120, *, is_doubled=True):
    angle = 2 * np.pi * np.arange(n) / n
    points = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    lines = np.stack([np.arange(n), (np.arange(n) + 1) % n], axis=1)
    return points, np.concatenate([lines, lines[:, ::-1]]) if is_doubled else lines


def ball():
    """A ball of which every triangle is there twice, once in each direction."""
    sphere = trimesh.creation.icosphere(3)
    return np.array(sphere.vertices), np.concatenate([sphere.faces, sphere.faces[:, ::-1]])


def radii(result):
    boundary = result.mesh.points[np.unique(result.mesh.facets.boundary)]
    return np.linalg.norm(boundary, axis=1)


@pytest.mark.parametrize("source", [circle, ball])
def test_the_envelope_of_a_doubled_sheet_is_fitted_to_the_sheet(source):
    result = tusqh.mesh(source(), cells=12, inside="envelope", fit=True)
    assert result.report.measured == (1, 0, 0)
    assert result.fit.target.trusted > 0.95
    assert np.abs(radii(result) - 1).max() < 0.02


@pytest.mark.parametrize(("source", "betti"), [(circle, (1, 1, 0)), (ball, (1, 0, 1))])
def test_a_shell_is_fitted_to_both_of_its_offsets(source, betti):
    result = tusqh.mesh(source(), cells=14, inside="shell", thickness=0.4, fit=True)
    assert result.report.measured == betti
    found = radii(result)
    is_outer = found > 1
    assert np.abs(found[is_outer] - 1.2).max() < 0.03
    assert np.abs(found[~is_outer] - 0.8).max() < 0.05


def test_a_union_has_only_the_outer_offset():
    points, lines = circle(is_doubled=False)
    result = tusqh.mesh((points, lines), cells=14, inside="union", thickness=0.4, fit=True)
    assert result.report.measured == (1, 0, 0)
    assert np.abs(radii(result) - 1.2).max() < 0.03


def test_a_window_cuts_an_envelope_and_its_sides_stay_plane():
    result = tusqh.mesh(
        circle(), cells=12, inside="envelope", fit=True, window=((0.0, -1.0), (1.0, 1.0))
    )
    assert result.mesh.measurement.volume == pytest.approx(np.pi / 2, rel=0.01)
    assert (result.mesh.points[:, 0] == 0.0).sum() > 10


@pytest.mark.parametrize("inside", [{"inside": "envelope", "seal": "0.4 cells"},
                                    {"inside": "shell", "thickness": 0.3}])  # fmt: skip
def test_the_record_and_the_certificate_are_recomputed_from_the_files(tmp_path, inside):
    result = tusqh.mesh(circle(), cells=12, fit=True, **inside)
    result.save(tmp_path)
    assert all(check.holds for check in recheck(tmp_path / "certificate.json", result.staircase))
    checks = recheck_fit(tmp_path / "fitted.vtu", result.mesh)
    assert all(check.holds for check in checks if not check.is_warning)
    certificate = (tmp_path / "certificate.json").read_text()
    assert '"inside": "envelope"' in certificate or '"inside": "shell"' in certificate
