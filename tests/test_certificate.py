"""A certificate is believed only as far as its mesh, recomputed, agrees."""

import json

import jsonschema
import numpy as np
import pytest
from fields import random_fractions
from typer.testing import CliRunner

from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.certificate import FILE_NAME, check_certificate, make_certificate, schema
from tusqh.cli.app import app
from tusqh.errors import MeshError
from tusqh.hashing import canonical_json
from tusqh.meshes.export import read_vtu, write_vtu
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.sampling.io import save_fractions
from tusqh.settings.goal import Goal
from tusqh.settings.policy import Criteria, Policy
from tusqh.threshold.choose import choose_threshold
from tusqh.threshold.plateaus import Plateaus


@pytest.fixture
def folder(tmp_path):
    """Return a folder with fractions, mesh and certificate, as the workflow leaves it."""
    fractions = random_fractions(np.random.default_rng(4), (9, 9), n_levels=9)
    policy = Policy(components=Criteria(min_cells=2), holes=Criteria(min_cells=2))
    cell_sets = CellSets(fractions, policy)
    selection, _ = choose_threshold(Plateaus(cell_sets), Goal(threshold=0.6), name="noise")
    resolved = build_mesh(cell_sets.at(0.6), fractions.grid, name="noise")
    assert len(resolved.cells.features) > 0
    save_fractions(tmp_path / "fractions.npz", fractions)
    write_vtu(tmp_path / "mesh.vtu", resolved.mesh)
    certificate = make_certificate(
        selection,
        resolved.cells,
        tmp_path / "mesh.vtu",
        tmp_path / "fractions.npz",
        name="noise",
    )
    (tmp_path / FILE_NAME).write_text(canonical_json(certificate))
    return tmp_path


def failed(folder):
    mesh_file = folder / "mesh.vtu"
    checks = check_certificate(folder / FILE_NAME, mesh_file, read_vtu(mesh_file))
    return [check.id for check in checks if not check.holds]


def change(folder, *keys, to):
    path = folder / FILE_NAME
    certificate = json.loads(path.read_text())
    inner = certificate
    for key in keys[:-1]:
        inner = inner[key]
    inner[keys[-1]] = to
    path.write_text(canonical_json(certificate))


def test_a_certificate_holds_and_follows_its_schema(folder):
    assert failed(folder) == []
    certificate = json.loads((folder / FILE_NAME).read_text())
    jsonschema.Draft202012Validator.check_schema(schema())
    jsonschema.validate(certificate, schema())
    assert certificate["holds"] is True
    assert certificate["predicted"]["effective"] == certificate["measured"]["euler"]
    assert {row["feature"] for row in certificate["features"]} <= {"component", "hole"}


def test_the_mesh_alone_is_enough(folder):
    (folder / "fractions.npz").unlink()
    assert failed(folder) == []
    change(folder, "measured", "boundary", to=[7, 7, 0])
    assert failed(folder) == ["certificate_boundary"]


@pytest.mark.parametrize(
    ("keys", "value", "name"),
    [
        (("measured", "euler"), [9, 9, 0], "certificate_euler"),
        (("predicted", "effective"), [9, 9, 0], "certificate_predicted"),
        (("predicted", "raw"), [99, 9, 0], "certificate_raw"),
        (("fractions", "sha256"), "0" * 64, "certificate_fractions"),
        (("mesh", "sha256"), "0" * 64, "certificate_mesh"),
        (("checks",), [], "certificate_checks"),
        (("features",), [], "certificate_features"),
        (("contacts", "decided"), 99, "certificate_contacts"),
        (("holds",), False, "certificate_holds"),
        (
            ("selection", "threshold"),
            0.1,
            "certificate_effective",
        ),
    ],
)
def test_every_claim_is_recomputed(folder, keys, value, name):
    change(folder, *keys, to=value)
    assert name in failed(folder)


def test_another_mesh_is_noticed(folder):
    mesh = read_vtu(folder / "mesh.vtu")
    write_vtu(
        folder / "mesh.vtu", VolumeMesh.from_arrays(mesh.points, mesh.cells[: len(mesh.cells) // 2])
    )
    assert "certificate_mesh" in failed(folder)


@pytest.mark.parametrize("content", ["", "{}", "[1]", "not json"])
def test_a_broken_certificate_is_an_error(folder, content):
    (folder / FILE_NAME).write_text(content)
    with pytest.raises(MeshError, match="not a valid certificate"):
        failed(folder)


def test_the_command_line_says_so_by_its_exit_code(folder):
    run = CliRunner().invoke
    done = run(app, ["check", str(folder / "mesh.vtu")])
    assert done.exit_code == 0, done.output
    assert "certificate" in done.output
    change(folder, "measured", "euler", to=[9, 9, 0])
    assert run(app, ["check", str(folder / "mesh.vtu")]).exit_code == 1
    (folder / FILE_NAME).unlink()
    done = run(app, ["check", str(folder / "mesh.vtu")])
    assert done.exit_code == 0
    assert "there is no certificate.json in its folder" in done.output


def test_no_certificate_for_a_mesh_that_is_not_as_predicted(folder):
    fractions = random_fractions(np.random.default_rng(4), (9, 9), n_levels=9)
    cell_sets = CellSets(fractions, Policy(bridges="none"))
    selection, _ = choose_threshold(Plateaus(cell_sets), Goal(threshold=0.3))
    with pytest.raises(MeshError, match="measured Betti numbers"):
        make_certificate(
            selection,
            cell_sets.at(0.3),
            folder / "mesh.vtu",
            folder / "fractions.npz",
            name="wrong",
        )
