"""The certificate of several materials is recomputed from mesh, fractions and geometry."""

import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest
import trimesh
from typer.testing import CliRunner

import tusqh
from tusqh.certificate import FILE_NAME
from tusqh.cli.app import app
from tusqh.contacts import MaterialFractions
from tusqh.contacts.fractions_file import load_materials, save_materials
from tusqh.errors import MeshError
from tusqh.geometry.canonical import load_geometry, write_geometry
from tusqh.geometry.outline import Outline
from tusqh.hashing import canonical_json, hash_file
from tusqh.meshes.export import read_regions, read_vtu, write_vtu
from tusqh.meshes.regions import Regions
from tusqh.pipeline.materials.certificate import materials_schema, read_certificate
from tusqh.pipeline.materials.original import MaterialsOriginal
from tusqh.pipeline.materials.recheck import check_materials

SQUARE = np.array([[0.0, 0], [4, 0], [4, 4], [0, 4], [0, 0]])
CORE = np.array([[1.1, 1.0], [2.7, 1.0], [1.1, 2.3], [1.1, 1.0]])


def mesh_surfaces(folder):
    """Mesh a ring and a ball that overlap; the ring has two objects."""
    ring = trimesh.creation.torus(3.0, 1.0)
    ball = trimesh.creation.icosphere(subdivisions=2, radius=2.4)
    return tusqh.mesh({"ring": ring, "ball": ball}, cells=12, materials={"ball": 0.7})


def mesh_outlines(folder):
    """Mesh an outline with a hole, the outline in it, and the rest of a window."""
    hole = Outline.from_chains([SQUARE, 1 + SQUARE[::-1] / 2])
    parts = {"frame": hole, "core": Outline.from_chains([CORE])}
    window = ((-1.0, -1.0), (5.0, 5.0))
    settings = {"cells": 12, "rest": "sea", "window": {"lower": window[0], "upper": window[1]}}
    return tusqh.mesh(parts, **settings)


def mesh_labels(folder):
    image = np.random.default_rng(3).integers(0, 3, (6, 6, 6)).astype(np.uint8)
    return tusqh.mesh(image, cells=3, materials={1: "bone", 2: {"name": "skin", "threshold": 0.8}})


def mesh_map(folder):
    image = np.random.default_rng(4).integers(0, 4, (9, 7)).astype(np.int16)
    return tusqh.mesh(image, materials={2: "land"}, rest="sea")


def mesh_fractions(folder):
    fields = np.random.default_rng(3).dirichlet(np.ones(3), (4, 3, 5))
    return tusqh.mesh(MaterialFractions.from_cells({"a": fields[..., 0], "b": fields[..., 1]}))


WITH_GEOMETRY = [mesh_surfaces, mesh_outlines, mesh_labels, mesh_map]


@pytest.fixture(scope="module", params=[*WITH_GEOMETRY, mesh_fractions], ids=lambda f: f.__name__)
def found(request):
    return request.param(None)


@pytest.fixture
def folder(found, tmp_path):
    found.save(tmp_path)
    return tmp_path


def read(folder):
    return json.loads((folder / FILE_NAME).read_text())


def failed(folder):
    verdict = check_materials(folder / "mesh.vtu")
    return set(verdict.loc[verdict["holds"] == "no", "id"])


def change(folder, edit):
    certificate = read(folder)
    edit(certificate)
    (folder / FILE_NAME).write_text(canonical_json(certificate))


def sign(folder, key):
    """State the digest of a changed file, as a forger would."""
    path = folder / read(folder)[key]["file"]
    change(folder, lambda c: c[key].update(sha256=hash_file(path)))


def test_every_certificate_follows_its_schema_and_holds(found, folder):
    jsonschema.Draft202012Validator.check_schema(materials_schema())
    certificate = read(folder)
    jsonschema.validate(certificate, materials_schema())
    assert read_certificate(folder / FILE_NAME) == certificate
    assert failed(folder) == set()
    assert certificate["holds"]
    assert ("geometry" in certificate) == (found.original is not None)
    ids = set(check_materials(folder / "mesh.vtu")["id"])
    assert ("certificate_resampled" in ids) == (found.original is not None)
    betti = dict(zip(found.materials["material"], found.materials.to_dict("records"), strict=True))
    for name, predicted in certificate["predicted"].items():
        assert predicted == [betti[name][f"betti_{k}_predicted"] for k in range(3)]
        assert certificate["measured"][name]["elements"] == betti[name]["elements"]
    assert CliRunner().invoke(app, ["check", str(folder / "mesh.vtu")]).exit_code == 0


def test_geometry_and_settings_give_the_same_fractions_again(found, folder):
    if found.original is None:
        return
    again = MaterialsOriginal.load(folder / "geometry.vtp", found.original.to_dict()).sample()
    for name in ("start", "material", "multiple"):
        assert np.array_equal(getattr(again.fractions, name), getattr(found.fractions, name))
    assert again.fractions.names == found.fractions.names


EDITS = [
    ("mesh", lambda c: c["mesh"].update(sha256="0" * 64)),
    ("fractions", lambda c: c["fractions"].update(sha256="0" * 64)),
    ("measured", lambda c: c["measured"]["all"].update(euler=[9, 9, 9])),
    ("measured", lambda c: c["measured"]["all"].update(elements=7)),
    ("predicted", lambda c: c["predicted"].update(all=[9, 9, 9])),
    ("predicted", lambda c: c["predicted"].pop(min(set(c["predicted"]) - {"all"}))),
    ("contacts", lambda c: c["contacts"].update(decided=999)),
    ("holds", lambda c: c.update(holds=False)),
    ("warnings", lambda c: c.update(volume_tolerance=1.0 if c["warnings"] else 1e-9)),
    ("elements", lambda c: c["thresholds"].update({min(c["thresholds"]): 0.02})),
]


@pytest.mark.parametrize("found", [mesh_labels], indirect=True)
@pytest.mark.parametrize(("name", "edit"), EDITS)
def test_every_claim_is_recomputed(folder, name, edit):
    change(folder, edit)
    assert f"certificate_{name}" in failed(folder)


def test_tampering_with_the_mesh_is_found(folder):
    """One element has another material, then one point is elsewhere; both are signed."""
    path = folder / "mesh.vtu"
    mesh, regions = read_vtu(path), read_regions(path)
    material = regions.material.copy()
    material[0] = (material[0] + 1) % (len(regions.names) - 1)
    write_vtu(path, mesh, regions=Regions(regions.names, material))
    assert "certificate_mesh" in failed(folder)
    sign(folder, "mesh")
    assert "certificate_elements" in failed(folder)
    mesh.points[mesh.cells[0, 0]] += 1e-4
    write_vtu(path, mesh, regions=regions)
    sign(folder, "mesh")
    assert "certificate_elements" in failed(folder)


def test_tampering_with_fractions_is_found(found, folder):
    """A fraction is another one; only the geometry tells, if mesh and certificate fit it."""
    path = folder / "fractions.npz"
    fractions = load_materials(path)
    multiple = fractions.multiple.copy()
    multiple[np.argmax(multiple)] -= 2**12
    changed = MaterialFractions(
        fractions.grid, fractions.names, fractions.start, fractions.material, multiple
    )
    save_materials(path, changed)
    assert "certificate_fractions" in failed(folder)
    sign(folder, "fractions")
    if found.original is not None:
        assert "certificate_resampled" in failed(folder)


def test_tampering_with_the_geometry_is_found(found, folder):
    """A vertex of a surface is elsewhere, or a voxel has another label; both are signed."""
    if found.original is None:
        return
    path = folder / "geometry.vtp"
    geometry = load_geometry(path)
    if hasattr(geometry, "voxels"):
        first = (0,) * geometry.voxels.ndim
        geometry.voxels[first] = (geometry.voxels[first] + 1) % 3
    else:
        geometry.points[0] += 0.4
    write_geometry(path, geometry)
    assert "certificate_geometry" in failed(folder)
    sign(folder, "geometry")
    assert "certificate_resampled" in failed(folder)
    path.unlink()
    verdict = check_materials(folder / "mesh.vtu").set_index("id")
    assert verdict.loc["certificate_resampled", "holds"] == "not run"


def test_tampering_with_settings_is_found(found, folder):
    if found.original is None:
        return
    change(folder, lambda c: c["settings"]["grid"].update(cells=2))
    assert "certificate_resampled" in failed(folder)


def test_the_mesh_alone_and_its_recorded_warnings_are_enough(found, folder):
    (folder / "fractions.npz").unlink()
    verdict = check_materials(folder / "mesh.vtu").set_index("id")
    assert not (verdict["holds"] == "no").any()
    warned = {row["id"] for row in read(folder)["warnings"]}
    assert set(verdict.index[verdict["holds"] == "warning"]) == warned


BROKEN = ["", "{}", "[1]", "not json"]


@pytest.mark.parametrize("content", BROKEN)
def test_a_broken_certificate_is_an_error(tmp_path, content):
    tusqh.mesh(np.array([[1, 2]]), materials="labels").save(tmp_path)
    (tmp_path / FILE_NAME).write_text(content)
    with pytest.raises(MeshError, match="not a valid certificate of several materials"):
        check_materials(tmp_path / "mesh.vtu")
    assert Path(tmp_path / "geometry.vtp").is_file()


WRONG = [
    lambda c: c.update(more=1),
    lambda c: c["mesh"].update(file="../mesh.vtu"),
    lambda c: c["thresholds"].update(a=2),
    lambda c: c["predicted"].update(all=[1, 0]),
    lambda c: c.pop("settings"),
    lambda c: c.update(certificate="materials 1"),
]


@pytest.mark.parametrize("edit", WRONG)
def test_the_schema_refuses_what_it_does_not_know(tmp_path, edit):
    tusqh.mesh(np.array([[1, 2]]), materials="labels").save(tmp_path)
    change(tmp_path, edit)
    with pytest.raises(MeshError, match="not a valid certificate"):
        read_certificate(tmp_path / FILE_NAME)
