"""`tusqh check` repeats the sampling, the placement of the grid and the warnings."""

import json

import numpy as np
import pytest
import trimesh
from typer.testing import CliRunner

import tusqh
from tusqh.certificate import FILE_NAME
from tusqh.cli.app import app
from tusqh.hashing import canonical_json
from tusqh.meshes.export import read_vtu
from tusqh.pipeline.recheck import recheck


@pytest.fixture(scope="module")
def enclosure():
    """Return a closed box whose walls are one and a half cells thick, on a moved grid."""
    outer = trimesh.creation.box(bounds=[[0, 0, 0], [12, 9, 6]])
    inner = trimesh.creation.box(bounds=[[1.5] * 3, [10.5, 7.5, 4.5]])
    inner.invert()
    mesh = trimesh.util.concatenate([outer, inner])
    return tusqh.mesh((np.asarray(mesh.vertices), np.asarray(mesh.faces)), cells=12, name="box")


@pytest.fixture
def folder(enclosure, tmp_path):
    enclosure.save(tmp_path)
    return tmp_path


def checks(folder):
    found = recheck(folder / FILE_NAME, read_vtu(folder / "mesh.vtu"))
    return {check.id: check for check in found}


def change(folder, edit):
    path = folder / FILE_NAME
    certificate = json.loads(path.read_text())
    edit(certificate)
    path.write_text(canonical_json(certificate))


def test_fractions_placement_and_warnings_are_the_same_again(enclosure, folder):
    assert enclosure.fractions.placement.is_moved
    found = checks(folder)
    for name in ("certificate_geometry", "certificate_placement", "certificate_warnings"):
        assert found[name].holds, found[name]
    assert found["volume"].found == enclosure.report.verdict.set_index("id").found["volume"]
    assert CliRunner().invoke(app, ["check", str(folder / "mesh.vtu")]).exit_code == 0


def test_a_warning_that_was_taken_out_is_missed(folder):
    change(
        folder, lambda c: c.update(warnings=[{"id": "x", "name": "x", "found": "", "remedy": ""}])
    )
    assert checks(folder)["certificate_warnings"].holds is False
    assert CliRunner().invoke(app, ["check", str(folder / "mesh.vtu")]).exit_code == 1


def test_a_place_of_the_grid_that_is_not_the_best_is_found(folder):
    change(folder, lambda c: c["placement"].update(error=0.0001))
    found = checks(folder)
    assert found["certificate_placement"].holds is False
    assert found["certificate_geometry"].holds


def test_another_geometry_is_found(folder):
    box = trimesh.creation.box(bounds=[[0, 0, 0], [12, 9, 6]])
    other = tusqh.mesh((np.asarray(box.vertices), np.asarray(box.faces)), cells=12)
    other.save(folder / "other")
    (folder / "other/geometry.vtp").replace(folder / "geometry.vtp")
    assert checks(folder)["certificate_geometry"].holds is False


def test_without_the_geometry_the_warnings_are_those_recorded(folder):
    (folder / "geometry.vtp").unlink()
    change(
        folder, lambda c: c.update(warnings=[{"id": "x", "name": "y", "found": "z", "remedy": "w"}])
    )
    (check,) = checks(folder).values()
    assert (check.id, check.found, check.is_warning) == ("x", "z", True)
    assert (
        "as recorded by the certificate: geometry.vtp is missing from its folder" in check.required
    )
    change(folder, lambda c: c.update(warnings=[]))
    (check,) = checks(folder).values()
    assert check.holds is None


@pytest.mark.parametrize("what", ["image", "outline"])
def test_images_and_outlines_too(what, tmp_path):
    source = (
        np.ones((6, 5, 4))
        if what == "image"
        else ([[0, 0], [3, 0], [0, 2.0]], [[0, 1], [1, 2], [2, 0]])
    )
    result = tusqh.mesh(source, cells=6, name=what)
    result.save(tmp_path)
    assert all(check.holds for key, check in checks(tmp_path).items() if "certificate" in key)
