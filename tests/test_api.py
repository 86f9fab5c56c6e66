"""`import tusqh` is light, and `tusqh.mesh` gives the workflow's results for any source."""

import json
import subprocess
import sys

import numpy as np
import pandas as pd
import pytest
import pyvista
import trimesh

import tusqh
from tusqh.errors import ConfigError, GeometryError, SamplingError, TopologyError
from tusqh.hashing import hash_file
from tusqh.meshes.betti import betti_by_boundary
from tusqh.meshes.export import read_vtu
from tusqh.pipeline.ingest import ingest

FRAME = (
    [[0, 0], [3, 0], [3, 3], [0, 3], [1, 1], [1, 2], [2, 2], [2, 1]],
    [[0, 1], [1, 2], [2, 3], [4, 5], [5, 6], [6, 7], [7, 4]],
)


@pytest.fixture(scope="module")
def torus():
    return trimesh.creation.torus(10.0, 3.5, major_sections=24, minor_sections=12)


@pytest.fixture(scope="module")
def result(torus):
    return tusqh.mesh(torus, cells=14, betti=(1, 1, 0), name="ring")


def test_importing_tusqh_imports_nothing_heavy():
    code = (
        "import sys, tusqh; heavy = {'numpy', 'pandas', 'scipy', 'numba', 'vtk', 'pyvista', "
        "'trimesh', 'meshio', 'mfem', 'gudhi', 'igl', 'matplotlib', 'snakemake', 'typer'}; "
        "found = heavy & set(sys.modules); assert not found, found; tusqh.mesh; "
        "assert 'numpy' in sys.modules; optional = {'pymeshlab', 'mfem', 'skimage', 'snakemake'}; "
        "assert not optional & set(sys.modules), optional & set(sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_the_public_names_are_those_that_are_declared():
    assert {"mesh", "Result", "TusqhError", "__version__"} <= set(dir(tusqh))
    assert all(getattr(tusqh, name) is not None for name in dir(tusqh))
    with pytest.raises(AttributeError, match="no attribute 'mash'"):
        _ = tusqh.mash


def test_the_result_has_prediction_choice_measurement_and_verdict(result):
    report = result.report
    assert report.predicted == report.measured == (1, 1, 0) == betti_by_boundary(result.mesh)
    assert report.is_met
    assert report.is_suitable
    assert 0 < report.selection.threshold <= 1
    assert "as predicted" in str(report)
    assert list(result.curves.columns[:4]) == ["upper", "lower", "width", "betti_0"]
    assert (result.diagram["persistence"] > 0).all()
    assert result.settings.grid.cells == 14


def test_the_mesh_converts_to_three_libraries(result):
    mesh = result.mesh
    assert mesh.points.shape[1] == 3
    assert mesh.cells.shape[1] == 8
    grid, io, native = mesh.to_pyvista(), mesh.to_meshio(), mesh.to_mfem()
    assert grid.n_cells == len(io.cells[0].data) == native.GetNE() == mesh.n_cells
    assert grid.n_points == len(io.points) == native.GetNV() == len(mesh.points)
    assert np.array_equal(grid.points, io.points)
    assert grid.volume == pytest.approx(result.report.facts["volume"])
    assert io.cells[0].type == "hexahedron"


def test_files_and_objects_and_arrays_give_the_same_fractions(tmp_path, torus, result):
    torus.export(tmp_path / "ring.ply")
    sources = [
        tmp_path / "ring.ply",
        str(tmp_path / "ring.ply"),
        trimesh.Scene([torus]),
        pyvista.wrap(torus),
        (torus.vertices, torus.faces),
        (torus.vertices.tolist(), torus.faces.tolist()),
    ]
    points = ingest(sources[0]).points  # PLY has single precision.
    for source in sources:
        soup = ingest(source)
        assert np.allclose(soup.points[soup.triangles], points[ingest(sources[0]).triangles])
    for source in sources[2:]:
        again = tusqh.mesh(source, cells=14, betti=(1, 1, 0))
        assert np.array_equal(again.fractions.values, result.fractions.values)
        assert np.array_equal(again.mesh.cells, result.mesh.cells)


def test_arrays_in_the_plane_are_an_outline():
    result = tusqh.mesh(FRAME, cells=12, betti=(1, 1))
    assert result.mesh.points.shape[1] == 2
    assert result.report.measured == (1, 1, 0)
    assert result.mesh.to_mfem().Dimension() == 2
    assert result.mesh.to_meshio().cells[0].type == "quad"
    defects = result.defects.set_index("defect")
    assert defects["count"]["open_chains"] == 1
    # One side of the outer square is missing: around it the winding number is below 1.
    assert 0.5 < defects["measure"]["winding_number_max"] <= 1


def test_the_workflow_gives_the_same_files(built, tmp_path):
    """Processes that exchange files give the same results as one call in memory."""
    source = built / "data_sources/ring.stl"
    result = tusqh.mesh(source, unit="mm", cells=12, betti=(1, 1), components={"min_cells": 2})
    result.save(tmp_path)
    names = {path.name for path in tmp_path.iterdir()}
    assert {"mesh.vtu", "certificate.json", "verdict.csv", "fractions.npz"} <= names
    for name in names:
        assert hash_file(tmp_path / name) == hash_file(built / "results/ring" / name), name


def test_saved_results_hold_their_certificate(tmp_path, result):
    result.save(tmp_path)
    certificate = json.loads((tmp_path / "certificate.json").read_text())
    assert certificate["holds"] is True
    assert certificate["model"] == "ring"
    assert pd.read_csv(tmp_path / "verdict.csv")["holds"].isin(["yes", "not run", "warning"]).all()
    for suffix in ("vtu", "msh", "mesh", "exo", "inp"):
        result.write(tmp_path / f"part.{suffix}")
        assert (tmp_path / f"part.{suffix}").stat().st_size > 1000
    assert np.array_equal(read_vtu(tmp_path / "part.vtu").cells, result.mesh.cells)


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        ({"cells": 0}, ["argument cells", "found 0", "a whole number of at least 1"]),
        ({"cells": 8.5}, ["cells", "found 8.5"]),
        ({"cells": 8, "cell_size": 0.1}, ["argument cells and argument cell_size: both are given"]),
        ({"cell_size": -1}, ["cell_size", "a number above 0"]),
        ({"betti": (1, -1)}, ["betti", "found -1"]),
        ({"betti": "100"}, ["betti", "found '100'"]),
        ({"betti": (None, None)}, ["betti", "at least one of betti_0"]),
        ({"betti": ({"least": 1},)}, ["betti", "'least'", "min"]),
        ({"betti": (1, 0, 0, 0)}, ["up to three"]),
        ({"betti": ({"min": 3, "max": 1},)}, ["betti", "min is not above"]),
        ({"threshold": 1.5}, ["threshold", "found 1.5", "above 0 and at most 1"]),
        ({"threshold": 0}, ["threshold", "found 0"]),
        ({"threshold": "a"}, ["threshold", "found 'a'"]),
        ({"threshold": float("nan")}, ["threshold", "found nan"]),
        ({"persistence": 2}, ["persistence", "found 2"]),
        ({"persistence": -1}, ["persistence", "found -1"]),
        ({"persistence": float("nan")}, ["persistence", "found nan"]),
        ({"tolerance": "x"}, ["tolerance", "of at least 1e-12 and at most 0.01"]),
        (
            {"components": {"min_cells": -1}},
            ["components, min_cells", "a whole number of at least 1"],
        ),
        ({"holes": {"min_persistence": 2}}, ["holes, min_persistence", "at most 1"]),
        (
            {"betti": (1,), "threshold": 0.5},
            ["argument threshold and argument betti", "one of the two"],
        ),
        (
            {"rule": "clamp"},
            ["rule", "found 'clamp'", "average, clamped", "did you mean 'clamped'?"],
        ),
        ({"bridges": "some"}, ["bridges", "forest, all, none"]),
        ({"volume": "same"}, ["volume", "match"]),
        ({"components": {"min_cell": 3}}, ["components", "min_cells"]),
        ({"window": ((0, 0, 0), (1, 0, 1))}, ["window", "above `lower` along every axis"]),
        ({"image": {"voxel": 3}}, ["image", "voxel_size"]),
        ({"sampels": 4}, ["tusqh.mesh: unknown argument 'sampels'", "did you mean 'samples'?"]),
        ({"min_cells": 4}, ["unknown argument 'min_cells'"]),
        ({"window": 3}, ["window", "the lowest and the highest corner"]),
    ],
)
def test_bad_arguments_are_explained(arguments, parts):
    with pytest.raises(ConfigError) as caught:
        tusqh.mesh(FRAME, **arguments)
    for part in parts:
        assert part in str(caught.value)


@pytest.mark.parametrize(
    ("source", "message"),
    [
        (3.5, "type float is not a geometry"),
        (np.zeros(4), r"shape \(4,\)"),
        (([[0, 0, 0]], [[0, 1]]), r"shapes \(1, 3\) and \(1, 2\)"),
        (([[0, 0, "x"]], [[0, 0, 0]]), "not numbers"),
        (([[0, 0, 1j]], [[0, 0, 0]]), "not numbers: points are complex"),
        (([[0, 0], [1, 0]], [[0, 5]]), "out of the range 0 .. 1"),
        (([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 7]]), "corners out of range"),
        (([[0, 0], [1, 0]], [[0, 0.5]]), "not whole numbers"),
        (trimesh.Trimesh(), "no triangle"),
        ("no_such_file.stl", "no such file"),
    ],
)
def test_sources_that_are_none_are_explained(source, message):
    with pytest.raises(GeometryError, match=message):
        tusqh.mesh(source)


@pytest.mark.parametrize("scale", [1e-200, 1e200])
def test_units_whose_volumes_are_no_numbers_are_explained(scale):
    sphere = trimesh.creation.icosphere(1)
    with pytest.raises(SamplingError, match="another unit of length"):
        tusqh.mesh((np.asarray(sphere.vertices) * scale, sphere.faces), cells=6)


def test_a_mesh_is_described_by_its_report(result):
    assert repr(result).startswith("mesh of ring")
    assert "measured" in repr(result)


def test_what_cannot_be_reached_is_listed():
    with pytest.raises(TopologyError, match="no threshold gives betti_0 = 7") as caught:
        tusqh.mesh(FRAME, cells=12, betti=(7,))
    assert "betti_0 = 1, betti_1 = 1" in str(caught.value)


def test_the_sampler_and_its_tolerance_can_be_chosen(torus):
    ours = tusqh.mesh(torus, cells=10, tolerance=1e-9)
    theirs = tusqh.mesh(torus, cells=10, sampler="libigl")
    assert np.abs(ours.fractions.values - theirs.fractions.values).max() < 0.02
    with pytest.raises(ConfigError, match="sampler"):
        tusqh.mesh(torus, sampler="guess")
