"""Runs in slabs: files, interruptions, certificates, and what is refused."""

import json
import shutil
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from typer.testing import CliRunner

import tusqh
from tusqh.cli.app import app
from tusqh.errors import ConfigError, MeshError, OutputError, SamplingError
from tusqh.grid.slabs import cut
from tusqh.pipeline.ingest import ingest
from tusqh.pipeline.slabs import elements
from tusqh.pipeline.slabs.mesh import mesh_in_slabs
from tusqh.pipeline.slabs.recheck import check_in_pieces
from tusqh.sampling import half_blocks
from tusqh.sampling.fractions import sample_fractions
from tusqh.sampling.io import load_fractions, save_fractions
from tusqh.sampling.layout import lay_grid
from tusqh.sampling.orient import orient
from tusqh.sampling.slab_sampler import SlabSampler
from tusqh.settings.model import Settings, Workflow
from tusqh.settings.sampling import Sampling

CELLS = 20


def ring():
    """Return points and triangles of a torus with one triangle missing."""
    made = trimesh.creation.torus(1.0, 0.4, major_sections=24, minor_sections=12)
    return made.vertices, made.faces[1:]


def mesh_ring(folder, n_slabs=3, results=None, **options):
    settings = Settings.from_dict({"grid": {"cells": CELLS}, "slabs": n_slabs, **options})
    outputs = [folder / "ring.pvtu", folder / "ring.vtu"]
    return mesh_in_slabs(ring(), settings, outputs, results=results, name="ring")


@pytest.mark.parametrize("options", [{}, {"rule": "clamped"}, {"domain": "outside"}])
def test_fractions_of_slabs_equal_those_of_the_whole_grid(monkeypatch, options):
    monkeypatch.setattr(half_blocks, "SAMPLES_AT_A_TIME", 1000)  # Several chunks.
    geometry = orient(ingest(ring()), "auto").geometry
    grid, sampling = lay_grid(geometry, None, cells=CELLS), Sampling.from_dict(options)
    whole = sample_fractions(geometry, grid, sampling=sampling).multiples
    for n_slabs in (1, 2, 5):
        sampler = SlabSampler.of(geometry, grid, sampling, None)
        sampler.take_all()
        for slab in cut(grid, n_slabs):
            assert np.array_equal(sampler.sample(slab), whole[slab.rows])


def test_one_file_has_the_bytes_of_the_mesh_in_one_piece(tmp_path):
    whole = tusqh.mesh(ring(), cells=CELLS, name="ring")
    whole.write(tmp_path / "whole.vtu")
    for n_slabs in (1, 2, 5):
        found = mesh_ring(tmp_path, n_slabs)
        assert (tmp_path / "ring.vtu").read_bytes() == (tmp_path / "whole.vtu").read_bytes()
        same = ("predicted", "mesh", "measured", "grid")
        lines = found.report.lines()
        assert {k: lines[k] for k in same} == {k: whole.report.lines()[k] for k in same}
        assert sorted(p.name for p in tmp_path.iterdir()) == [
            *("ring.pvtu", "ring.vtu", "ring_pieces", "whole.vtu")
        ]


def test_a_grid_that_is_moved_gives_the_same_mesh(tmp_path):
    plate = trimesh.creation.box([1, 1, 0.33])
    whole = tusqh.mesh(plate, cells=12, name="plate")
    assert whole.fractions.placement.is_moved
    whole.write(tmp_path / "whole.vtu")
    found = tusqh.mesh(plate, cells=12, name="plate", slabs=3, output=tmp_path / "plate.vtu")
    assert (tmp_path / "plate.vtu").read_bytes() == (tmp_path / "whole.vtu").read_bytes()
    assert found.report.facts["placement"] == whole.facts["placement"]


def test_paraview_reads_the_pieces_as_one_mesh(tmp_path):
    pyvista = pytest.importorskip("pyvista")
    mesh_ring(tmp_path)
    pieces, whole = pyvista.read(tmp_path / "ring.pvtu"), pyvista.read(tmp_path / "ring.vtu")
    assert pieces.n_cells == whole.n_cells
    assert np.array_equal(pieces.cell_data["grid_cell"], whole.cell_data["grid_cell"])
    assert np.array_equal(pieces.cell_data["volume_fraction"], whole.cell_data["volume_fraction"])
    assert np.array_equal(whole.points[pieces.point_data["point_number"]], pieces.points)


def test_an_interrupted_run_goes_on_where_it_stopped(tmp_path, monkeypatch):
    expected = tmp_path / "expected"
    mesh_ring(expected, 4)
    emitted, sampled = [], []
    emit, sample = elements.emit_slab, SlabSampler.sample

    def emit_some(decision, grid, slab, **options):
        if slab.number == 2 and len(emitted) == 2:
            raise KeyboardInterrupt
        emitted.append(slab.number)
        return emit(decision, grid, slab, **options)

    def sample_some(self, slab):
        if slab.number == 1 and len(sampled) == 1:
            sampled.append(-1)
            raise KeyboardInterrupt
        sampled.append(slab.number)
        return sample(self, slab)

    monkeypatch.setattr(elements, "emit_slab", emit_some)
    monkeypatch.setattr(SlabSampler, "sample", sample_some)
    folder = tmp_path / "found"
    for _ in range(2):
        with pytest.raises(KeyboardInterrupt):
            mesh_ring(folder, 4)
        assert not list(folder.glob("*tu"))
    # A process that is killed while it writes leaves a temporary file, which is removed.
    (folder / "ring_slabs" / ".elements-0123-0002-abcdefgh.npz").write_bytes(b"half")
    emitted.append(-1)
    mesh_ring(folder, 4)
    assert sampled == [0, -1, 1, 2, 3]
    assert emitted == [0, 1, -1, 2, 3]
    for name in ("ring.vtu", "ring.pvtu", "ring_pieces/0002.vtu"):
        assert (folder / name).read_bytes() == (expected / name).read_bytes()
    assert not (folder / "ring_slabs").exists()


def test_other_inputs_do_not_take_slabs_of_before(tmp_path, monkeypatch):
    def stop(*_arguments, **_options):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(elements.SlabMesh, "piece", stop)
        with pytest.raises(KeyboardInterrupt):
            mesh_ring(tmp_path, threshold=0.5)
    old = {path.name for path in (tmp_path / "ring_slabs").glob("elements-*")}
    assert len(old) == 3
    mesh_ring(tmp_path, threshold=0.3)
    mesh_ring(tmp_path / "fresh", threshold=0.3)
    assert (tmp_path / "ring.vtu").read_bytes() == (tmp_path / "fresh/ring.vtu").read_bytes()


def found_in(folder):
    table, _ = check_in_pieces(folder / "mesh.pvtu")
    return dict(zip(table["id"], table["holds"], strict=True))


def test_the_certificate_is_recomputed_and_notices_changes(tmp_path):
    mesh_ring(tmp_path, results=tmp_path / "results")
    folder = tmp_path / "results"
    stored = json.loads((folder / "certificate.json").read_text())
    assert (stored["measured"]["euler"], len(stored["mesh"]["pieces"])) == ([1, 1, 0], 3)
    found = found_in(folder)
    assert set(found.values()) == {"yes", "not run"}
    assert found["certificate_cells"] == found["certificate_fractions"] == "yes"
    fractions = folder / "fractions_pieces"
    of_slab = load_fractions(fractions / "0001.npz")
    of_slab.multiples[1:4, 1:4, 1:4] = 2**20  # One more cell.
    save_fractions(fractions / "0001.npz", of_slab)
    found = found_in(folder)
    assert found["certificate_fractions"] == found["certificate_cells"] == "no"
    save_fractions(fractions / "0001.npz", replace(of_slab, multiples=of_slab.multiples[2:]))
    with pytest.raises(MeshError, match=r"0001\.npz: holds fractions of shape \(13, "):
        found_in(folder)
    shutil.rmtree(fractions)
    (folder / "fractions.json").unlink()
    text = (folder / "mesh.pvtu").read_text().splitlines()
    kept = [line for line in text if "0002.vtu" not in line]
    (folder / "mesh.pvtu").write_text("\n".join(kept))
    found = found_in(folder)
    assert found["certificate_mesh"] == "no"
    assert "certificate_cells" not in found
    (folder / "mesh_pieces/0001.vtu").unlink()
    with pytest.raises(MeshError, match=r"0001\.vtu: no such file"):
        found_in(folder)


def test_pvtu_files_of_others_are_refused(tmp_path):
    path = tmp_path / "other.pvtu"
    path.write_text("<VTKFile/>")
    with pytest.raises(MeshError, match="it names no pieces"):
        check_in_pieces(path)
    path.write_text("no xml")
    with pytest.raises(MeshError, match="cannot be read as a mesh in pieces"):
        check_in_pieces(path)


@pytest.mark.parametrize(
    ("options", "found"),
    [
        ({"target": {"betti_0": 1}}, "`target`"),
        ({"persistence": 0.3, "fit": True}, "`persistence` and `fit`"),
        ({"components": {"min_cells": 3}}, "`components`"),
        ({"bridges": "forest"}, "`bridges`"),
        ({"checks": "all"}, "`checks: all`"),
    ],
)
def test_what_needs_the_whole_mesh_is_refused_before_any_work(tmp_path, options, found):
    with pytest.raises(ConfigError, match=f"ring: {found}: not available in slabs"):
        mesh_ring(tmp_path, **options)
    assert not list(tmp_path.iterdir())


def test_other_geometries_formats_and_folders_are_refused(tmp_path):
    settings = Settings.from_dict({"grid": {"cells": 9}, "slabs": 2})
    with pytest.raises(ConfigError, match="not a surface in space"):
        mesh_in_slabs(np.ones((4, 4, 4)), settings, [tmp_path / "a.vtu"])
    with pytest.raises(MeshError, match=r"\.msh, for a mesh in slabs"):
        mesh_in_slabs(ring(), settings, [tmp_path / "a.msh"])
    (tmp_path / "a_slabs").mkdir()
    (tmp_path / "a_slabs" / "thesis.tex").write_text("mine")
    with pytest.raises(OutputError, match=r"holds thesis\.tex, which is not a slab"):
        mesh_in_slabs(ring(), settings, [tmp_path / "a.vtu"])


def test_python_takes_slabs_with_an_output(tmp_path):
    result = tusqh.mesh(ring(), cells=12, slabs="auto", output=tmp_path / "ring.pvtu", name="ring")
    assert result.paths == (tmp_path / "ring.pvtu",)
    assert str(result.measurement.by_euler) == "(1, 1, 0)"
    for options in ({"slabs": 2}, {"output": "a.vtu"}):
        with pytest.raises(ConfigError, match="`slabs` and `output` together"):
            tusqh.mesh(ring(), cells=12, **options)
    with pytest.raises(ConfigError, match="`materials` with `slabs`"):
        tusqh.mesh([ring()], cells=12, slabs=2, output="a.vtu")


@pytest.mark.parametrize(
    ("options", "found"),
    [
        ({"target": {"betti_0": 1}, "fit": True}, "found 4 with `target` and `fit`"),
        ({"materials": "parts"}, "found 4 with several materials"),
    ],
)
def test_the_configuration_refuses_what_needs_the_whole_mesh(options, found):
    block = {"models": {"a": {"geometry": "a.stl", "slabs": 4}}}
    assert Workflow.from_dict(block).models["a"].settings.memory.slabs == 4
    block["models"]["a"] |= options
    with pytest.raises(ConfigError, match=rf"models\.a\.slabs: {found}"):
        Workflow.from_dict(block)


def test_a_grid_that_does_not_fit_is_refused_and_slabs_are_named(tmp_path, monkeypatch):
    free = 46_000_000
    monkeypatch.setattr("tusqh.sampling.memory.available_memory", lambda: free)
    monkeypatch.setattr("tusqh.pipeline.slabs.limits.available_memory", lambda: free)
    with pytest.raises(SamplingError, match="`--slabs auto`, which makes the same mesh in pieces"):
        tusqh.mesh(ring(), cells=60)
    with pytest.raises(SamplingError, match=r"(?s)in 2 slabs needs about .* use more slabs"):
        tusqh.mesh(ring(), cells=60, slabs=2, output=tmp_path / "ring.vtu")
    assert not list(tmp_path.iterdir())


def run(*arguments):
    done = CliRunner().invoke(app, [str(argument) for argument in arguments])
    return done.exit_code, done.output, done.exception


def test_the_command_line_makes_and_checks_meshes_in_slabs(tmp_path):
    source, results = "data_sources/solids/torus.stl", tmp_path / "results"
    made = ("mesh", source, "--cells", 16, "--slabs", 2, "-o", tmp_path / "a.vtu")
    code, text, _ = run(*made, "--results", results)
    assert code == 0, text
    assert "Betti numbers (1, 1, 0), as predicted" in text
    assert run("check", results / "mesh.pvtu")[0] == 0
    for extra, message in (
        (("--materials",), "several materials with --slabs"),
        (("--picture", tmp_path / "a.png"), "--picture with --slabs"),
    ):
        assert message in str(run(*made, *extra)[2])
    refused = run("check", results / "mesh.pvtu", "--all-checks")[2]
    assert "--all-checks of a mesh in pieces" in str(refused)
