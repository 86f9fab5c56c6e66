"""The output, the files and the exit codes of `tusqh mesh` and `tusqh inspect`."""

import json
import os
import signal
import subprocess
import sys
import warnings

import meshio
import mfem.ser as mfem
import numpy as np
import pytest
import pyvista
import trimesh
from drawings import is_drawn
from typer.testing import CliRunner

from tusqh.cli.app import app, main
from tusqh.meshes.betti import betti_by_boundary
from tusqh.meshes.export import read_vtu

COMMAND = [sys.executable, "-m", "tusqh"]


@pytest.fixture(scope="module")
def ring(tmp_path_factory):
    """Return a torus with two triangles missing."""
    path = tmp_path_factory.mktemp("parts") / "ring.stl"
    torus = trimesh.creation.torus(10.0, 3.5, major_sections=24, minor_sections=12)
    torus.update_faces([k not in (7, 90) for k in range(len(torus.faces))])
    torus.export(path)
    return path


def run(*arguments, folder=None):
    """Run the command line in a separate process, as a user does."""
    words = [str(argument) for argument in arguments]
    return subprocess.run([*COMMAND, *words], cwd=folder, capture_output=True, text=True)


@pytest.fixture
def call(capfd, monkeypatch, tmp_path):
    """Run the command line in this process, in an empty folder."""

    def call(*arguments):
        monkeypatch.setattr(sys, "argv", ["tusqh", *map(str, arguments)])
        monkeypatch.setattr("tusqh.cli.app.catch_signals", lambda: None)
        monkeypatch.chdir(tmp_path)
        with pytest.raises(SystemExit) as caught, warnings.catch_warnings():
            main()
        # The frame around usage errors may break lines.
        out, err = (" ".join(text.replace("│", " ").split()) for text in capfd.readouterr())
        assert "Traceback" not in err
        return caught.value.code, out, err

    return call


def test_a_mesh_that_meshio_and_mfem_read(ring, tmp_path):
    done = run("mesh", ring, "--cells", 12, "--betti", "1,1,0", "-o", "part.vtu", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    for line in ("wanted", "predicted", "threshold", "measured", "verdict"):
        assert line in done.stdout
    assert "Betti numbers (1, 1, 0), as predicted" in done.stdout
    assert "suitable" in done.stdout
    assert done.stderr.strip() == ""
    mesh = read_vtu(tmp_path / "part.vtu")
    assert betti_by_boundary(mesh) == (1, 1, 0)
    by_meshio = meshio.read(tmp_path / "part.vtu")
    assert len(by_meshio.cells_dict["hexahedron"]) == mesh.n_cells
    by_mfem = mfem.Mesh(str(tmp_path / "part.vtu"), 1, 1)
    assert by_mfem.GetNE() == mesh.n_cells
    assert by_mfem.GetNV() == len(mesh.points)
    assert [path.name for path in tmp_path.iterdir()] == ["part.vtu"]


def test_the_default_output_several_outputs_and_a_folder(ring, tmp_path):
    done = run("mesh", ring, "--cells", 10, "--json", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    assert report["met"] is report["suitable"] is True
    assert report["threshold"] == 0.5
    assert report["predicted"] == report["measured"]
    assert (tmp_path / "ring.vtu").is_file()
    names = [f"part.{suffix}" for suffix in ("msh", "mesh", "exo", "inp")]
    outputs = [word for name in names for word in ("-o", name)]
    done = run("mesh", ring, "--cells", 10, *outputs, "--results", "all", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert all((tmp_path / name).stat().st_size > 1000 for name in names)
    checked = run("check", tmp_path / "all/mesh.vtu")
    assert checked.returncode == 0, checked.stdout
    assert "certificate" in checked.stdout
    assert mfem.Mesh(str(tmp_path / "part.mesh")).GetNE() == report["mesh"]["elements"]


def test_a_topology_that_cannot_be_had_is_exit_code_1(ring, call, tmp_path):
    code, _, err = call("mesh", ring, "--cells", 10, "--betti", "9,9,9", "-o", "part.vtu")
    assert code == 1
    assert "no threshold gives betti_0 = 9" in err
    assert "betti_0 = 1, betti_1 = 1" in err
    assert list(tmp_path.iterdir()) == []


def test_both_samplers_see_the_same_topology(ring, call):
    for sampler in (["--tolerance", "1e-9"], ["--sampler", "libigl"]):
        code, out, _ = call("mesh", ring, "--cells", 8, "--betti", "1,1,0", *sampler)
        assert code == 0
        assert "betti_0 = 1, betti_1 = 1" in out


def test_ranges_and_stars(ring, call):
    code, out, _ = call("mesh", ring, "--cells", 10, "--betti", "1..2,*,..0", "-o", "part.vtu")
    assert code == 0
    assert "1 <= betti_0 <= 2, betti_2 <= 0" in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--betti", "1,x"], "option --betti: found '1,x'"),
        (["--cells", "many"], "option --cells: found 'many'"),
        (["--cells", "0"], "a whole number of at least 1"),
        (["--cells", "8", "--cell-size", "1"], "option --cells and option --cell-size: both"),
        (["--window", "1,2,3"], "a box as X0,Y0,X1,Y1"),
        (["--threshold", "0.5", "--betti", "1"], "option --threshold and option --betti"),
        (["--samples", "3"], "divisible by 2"),
        (["--rule", "clamp"], "average, clamped"),
        (["--betti", "3..1"], "min is not above its max"),
        (["--threshold", "1.5"], "above 0 and at most 1"),
        (["--persistence", "nan"], "above 0 and at most 1"),
        (["--sampler", "guess"], "crossings, libigl"),
        (["--tolerance", "0"], "of at least 1e-12 and at most 0.01"),
        (["-o", "part.stp"], "the suffix '.stp' names no format"),
        (["-o", "ring.stl"], "the suffix '.stl' names no format"),
        (["-o", "."], "names no format"),
        (["--nonsense"], "unknown option '--nonsense'"),
        (["--sampels=4"], "did you mean '--samples'?"),
        (["--holes-min-cells", "0"], "option --holes-min-cells: found 0"),
    ],
)
def test_bad_arguments_are_explained(ring, call, tmp_path, arguments, message):
    code, _, err = call("mesh", ring, *arguments)
    assert code == 2
    assert message in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("missing.stl", None, "there is no such file"),
        ("cut.stl", b"\0" * 80 + b"\x10\0\0\0" + b"\0" * 50, "promises 16 triangles"),
        ("empty.obj", b"", "error in"),
        ("noise.ply", b"\x89PNG\r\n\x1a\n" * 9, "it is a PNG picture"),
        ("page.geojson", b"<html>", "cannot be read"),
        ("part.docx", b"PK", "not supported"),
        ("package:none/part.stl", None, "has no file"),
    ],
)
def test_unreadable_files_are_explained(call, tmp_path, name, content, message):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    for command in (["mesh", name, "-o", "out/part.vtu"], ["inspect", name]):
        code, _, err = call(*command)
        assert code == 2
        assert message in err
        assert "remedy:" in err
    assert not (tmp_path / "out").exists()


def test_outputs_that_cannot_be_written_are_noticed_before_any_work(ring, call, tmp_path):
    (tmp_path / "file").write_text("")
    for arguments in (["-o", "file/part.vtu"], ["--results", "file/all"]):
        code, _, err = call("mesh", ring, *arguments)
        assert code == 2
        assert "cannot be written" in err
        assert "is a file" in err
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_the_geometry_is_never_replaced(ring, call, tmp_path):
    part = tmp_path / "part.vtu"
    pyvista.wrap(trimesh.load(ring)).cast_to_unstructured_grid().save(part)
    content = part.read_bytes()
    code, _, err = call("mesh", "part.vtu")
    assert code == 2
    assert "would replace the geometry" in err
    assert part.read_bytes() == content


def test_a_read_only_folder_is_noticed_before_any_work(ring, call, tmp_path, monkeypatch):
    folder = tmp_path / "kept"
    folder.mkdir()
    # Containers run tests as root, whom permissions do not bind, so replace the answer.
    really = os.access
    monkeypatch.setattr(os, "access", lambda path, mode: folder != path and really(path, mode))
    code, _, err = call("mesh", ring, "-o", folder / "new" / "part.vtu")
    assert code == 2
    assert f"the folder {folder} is read-only" in err
    assert not list(folder.iterdir())


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_run_leaves_what_was_there(ring, tmp_path, how):
    (tmp_path / "part.vtu").write_text("the mesh of yesterday")
    words = ["mesh", str(ring), "--cells", "70", "-o", "part.vtu"]
    process = subprocess.Popen(
        [*COMMAND, *words],
        cwd=tmp_path,
        env=os.environ | {"FORCE_COLOR": "1"},  # Progress is shown as on a terminal.
        stderr=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    for line in process.stderr:
        if "samples" in line:
            break
    process.send_signal(how)
    _, stderr = process.communicate(timeout=120)
    assert process.returncode == 128 + how
    assert "interrupted: " in stderr
    assert "Traceback" not in stderr
    assert [path.name for path in tmp_path.iterdir()] == ["part.vtu"]
    assert (tmp_path / "part.vtu").read_text() == "the mesh of yesterday"


def test_names_are_shown_as_they_are(ring, tmp_path):
    name = "[red]<script>alert(1)<"
    part = tmp_path / f"{name}.stl"
    part.write_bytes(ring.read_bytes())
    done = run("mesh", part, "--cells", 8, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / f"{name}.vtu").is_file()
    assert f"{name}.vtu" in "".join(done.stdout.split())
    done = run("inspect", part, "--cells", 8)
    assert f"Defects of {name}.stl" in done.stdout


def test_inspect_lists_defects_and_topologies(ring):
    done = run("inspect", ring, "--cells", 10)
    assert done.returncode == 0, done.stderr
    rows = [[cell.strip() for cell in line.split("│")[1:-1]] for line in done.stdout.splitlines()]
    boundary = next(row for row in rows if row and row[0] == "boundary_edges")
    assert boundary[1] == "6"
    assert any(row and row[0] == "winding_number_max" for row in rows)
    topologies = [row for row in rows if len(row) == 9]
    assert ["1", "1", "0"] in [row[-3:] for row in topologies]
    assert [row[1] for row in topologies].count("0.5") == 1
    edges = np.array([[float(x) for x in row[2:4]] for row in topologies])
    assert (edges[:, 0] < edges[:, 1]).all()
    assert 0 < edges[0, 1] <= 1


def test_inspect_can_stop_at_the_defects(ring, call):
    code, out, _ = call("inspect", ring, "--defects-only")
    assert code == 0
    assert "boundary_edges" in out
    assert "Topologies" not in out


@pytest.mark.parametrize("command", ["mesh", "inspect", "check", "add"])
def test_help_has_examples(command):
    done = CliRunner().invoke(app, [command, "--help"])
    assert done.exit_code == 0
    assert "For example" in done.output
    assert f"tusqh {command} " in done.output


def test_a_layer_a_picture_and_the_tables_of_sets(call, tmp_path):
    rings = "x0,y0,x1,y1\n0,0,9,0\n9,0,9,9\n9,9,0,9\n0,9,0,0\n"
    rings += "3,3,3,6\n3,6,6,6\n6,6,6,3\n6,3,3,3\n"
    (tmp_path / "frame.csv").write_text(rings)
    words = ["mesh", "frame.csv", "--cells", 9, "--betti", "1,1", "--set", "bore=near:4,4"]
    code, out, err = call(*words, "--layer", 0.5, "-o", "a.msh", "--picture", "a.png")
    assert code == 0, err
    assert "written a.msh, a_sets.csv, a.png" in out
    assert "elements scaled Jacobian at least 1.000" in out
    names = set(meshio.read(tmp_path / "a.msh").field_data)
    assert names == {"x_min", "x_max", "y_min", "y_max", "back", "front", "bore", "solid"}
    assert is_drawn(tmp_path / "a.png")
    code, out, err = call(*words, "-o", "b.vtu", "--sets")
    assert code == 0, err
    assert "written b.vtu, b_sets.csv, b_boundary.vtu" in out
    code, _, err = call(*words, "--picture", "a.bmp")
    assert code == 2
    assert "names no format of pictures" in err
    code, _, err = call(*words, "--element", "C3D9")
    assert code == 2
    assert "the element 'C3D9' is not known" in err
    code, _, err = call(*words, "--set", "bore=4,4")
    assert code == 2
    assert "NAME=near:X,Y,Z" in err
