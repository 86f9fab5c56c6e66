"""`tusqh mesh --materials` prints a row for every material."""

import json
import re

import meshio
import numpy as np
import trimesh
from typer.testing import CliRunner

from tusqh.cli.app import app
from tusqh.meshes.export import read_vtu, write_vtu
from tusqh.meshes.regions import Regions


def test_a_file_of_labels(tmp_path):
    image = np.zeros((8, 8, 8), dtype=np.uint8)
    image[1:7, 1:7, 1:7] = 1
    image[3:5, 3:5, 3:5] = 5
    np.save(tmp_path / "core.npy", image)
    out = tmp_path / "core.vtu"
    words = ["mesh", str(tmp_path / "core.npy"), "--materials", "-o", str(out)]
    done = CliRunner().invoke(app, [*words, "--json"])
    assert done.exit_code == 0, done.output
    report = json.loads(done.stdout)
    rows = {row["material"]: row for row in report["materials"]}
    betti = {n: [row[f"betti_{k}_measured"] for k in range(3)] for n, row in rows.items()}
    assert betti == {"1": [1, 0, 1], "5": [1, 0, 0], "all": [1, 0, 0]}
    assert [row["volume"] for row in rows.values()] == [208.0, 8.0, 216.0]
    numbers, counts = np.unique(meshio.read(out).cell_data["material"][0], return_counts=True)
    assert dict(zip(numbers, counts, strict=True)) == {1: 208, 2: 8}
    # Cells of two voxels.
    done = CliRunner().invoke(app, [*words, "--json", "--cells", "4"])
    report = json.loads(done.stdout)
    assert sum(row["elements"] for row in report["materials"][:-1]) < 216
    # Options without an effect are refused.
    done = CliRunner().invoke(app, [*words, "--betti", "1,0,0"])
    assert done.exit_code != 0
    assert "target together with several materials" in str(done.exception)


def test_a_file_for_each_material(tmp_path):
    for name, radius in (("core", 1.0), ("shell", 2.0)):
        trimesh.creation.icosphere(subdivisions=2, radius=radius).export(tmp_path / f"{name}.stl")
    sources = [str(tmp_path / "core.stl"), str(tmp_path / "shell.stl")]
    words = ["mesh", *sources, "--cells", "8", "-o", str(tmp_path / "out.exo")]
    done = CliRunner().invoke(app, [*words, "--materials", "--material", "core=1,0,0"])
    assert done.exit_code == 0, done.output
    assert re.search(r"core\W+32\W+4\W+\(1, 0, 0\)\W+\(1, 0, 0\)\W+yes", done.stdout)
    assert (tmp_path / "out.exo").stat().st_size > 0
    done = CliRunner().invoke(app, [*words, "--material", "core=3,0,0"])
    assert done.exit_code == 1
    for wrong, message in (
        ([], "2 geometries"),
        (["--material", "core"], "found 'core'"),
    ):
        done = CliRunner().invoke(app, [*words, *wrong])
        assert done.exit_code != 0
        assert message in str(done.exception)


def test_the_certificate_is_recomputed(tmp_path):
    """`tusqh check` accepts what was written, and notices a changed material and certificate."""
    image = np.zeros((8, 8, 8), dtype=np.uint8)
    image[1:7, 1:7, 1:7] = 1
    image[3:5, 3:5, 3:5] = 5
    np.save(tmp_path / "core.npy", image)
    words = ["mesh", str(tmp_path / "core.npy"), "--materials", "-o", str(tmp_path / "a.vtu")]
    done = CliRunner().invoke(app, [*words, "--results", str(tmp_path / "out")])
    assert done.exit_code == 0, done.output
    mesh = tmp_path / "out/mesh.vtu"
    done = CliRunner().invoke(app, ["check", str(mesh)])
    assert done.exit_code == 0, done.output
    for words in ("1: Betti numbers by boundary", "certificate: fractions"):
        assert words in done.stdout
    certificate = tmp_path / "out/certificate.json"
    stored = json.loads(certificate.read_text())
    assert stored["predicted"] == {"1": [1, 0, 1], "5": [1, 0, 0], "all": [1, 0, 0]}
    stored["predicted"]["5"] = [2, 0, 0]
    certificate.write_text(json.dumps(stored))
    done = CliRunner().invoke(app, ["check", str(mesh)])
    assert done.exit_code == 1
    # Materials drawn at random for each element are not manifolds.
    certificate.unlink()
    found = read_vtu(mesh)
    material = np.random.default_rng(0).integers(0, 2, found.n_cells)
    write_vtu(mesh, found, regions=Regions(("1", "5", "void"), material))
    done = CliRunner().invoke(app, ["check", str(mesh)])
    assert done.exit_code == 1
    assert "not suitable" in done.stdout
