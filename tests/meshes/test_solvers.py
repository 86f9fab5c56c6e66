"""CalculiX, MFEM and scikit-fem solve on exported files, by the names of their sets alone."""

import shlex

import numpy as np
import pandas as pd
import pytest
import trimesh
from plates import plate_outline, plate_surface
from solvers import (
    PULL,
    heat_by_calculix,
    heat_by_getfem,
    heat_by_mfem,
    heat_by_openfoam,
    heat_by_skfem,
    pull_by_calculix,
    pull_by_mfem,
    run_calculix,
)
from typer.testing import CliRunner

import tusqh
from tusqh.cli.app import app

#: Heat from a hole with the radius 8 to the sides of a plate of 60 x 40 x 8; see `test_heat`.
HEAT, THICKNESS = 44.826, 8.0


@pytest.fixture(scope="module")
def staircase():
    return tusqh.mesh(plate_outline(), cell_size=2.0, betti=(1, 1), name="plate")


@pytest.fixture(scope="module")
def fitted():
    outline = plate_outline(n=512)
    return tusqh.mesh(outline, cell_size=2.0, betti=(1, 1), fit=True, name="plate")


@pytest.fixture(scope="module")
def long_plate():
    outline = plate_outline(length=120.0, n=512)
    return tusqh.mesh(outline, cell_size=2.0, betti=(1, 1), fit=True, name="plate")


def test_heat_from_the_hole_is_the_same_in_all_programs(staircase, tmp_path):
    flows = []
    for dim, layer in ((2, None), (3, THICKNESS)):
        for suffix in (".msh", ".mesh", ".inp"):
            staircase.write(tmp_path / f"{dim}{suffix}", layer=layer)
        found = [
            heat_by_mfem(tmp_path / f"{dim}.mesh"),
            heat_by_skfem(tmp_path / f"{dim}.msh", dim),
        ]
        assert found[0] == pytest.approx(found[1], rel=1e-9)
        assert heat_by_calculix(tmp_path, f"{dim}.inp", dim) == pytest.approx(found[0], rel=1e-6)
        flows.append(found[0] * (THICKNESS if dim == 2 else 1))
    assert flows[0] == pytest.approx(flows[1], rel=1e-9)
    # The staircase's corners disturb the flow, and its hole is not round.
    assert abs(flows[0] / HEAT - 1) > 0.005


@pytest.mark.parametrize("dim", [2, 3])
def test_getfem_finds_the_same_heat(staircase, dim, tmp_path):
    staircase.write(tmp_path / "a.msh", layer=THICKNESS if dim == 3 else None)
    expected = heat_by_skfem(tmp_path / "a.msh", dim)
    assert heat_by_getfem(tmp_path / "a.msh", dim) == pytest.approx(expected, rel=1e-6)


def test_finite_volumes_of_openfoam_find_about_the_same_heat(tmp_path):
    fine = tusqh.mesh(plate_outline(), cell_size=1.0, betti=(1, 1), name="plate")
    fine.write(tmp_path / "a.msh", layer=THICKNESS)
    expected = heat_by_skfem(tmp_path / "a.msh", 3)
    found = heat_by_openfoam(tmp_path, tmp_path / "a.msh")
    assert found == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize("element", ["quad4", "quad8", "quad9"])
def test_heat_from_the_fitted_hole_is_that_of_the_round_one(fitted, element, tmp_path):
    fitted.write(tmp_path / "a.mesh", element=element)
    flow = THICKNESS * heat_by_mfem(tmp_path / "a.mesh")
    assert flow == pytest.approx(HEAT, rel=5e-3 if element == "quad4" else 2e-3)


@pytest.fixture(scope="module")
def coarse():
    outline = plate_outline(length=80.0, n=512)
    return tusqh.mesh(outline, cell_size=4.0, betti=(1, 1), fit=True, name="plate")


@pytest.mark.parametrize("types", [("CPS4", "CPS8"), ("C3D8", "C3D20")], ids=["plane", "space"])
def test_calculix_and_mfem_agree_on_the_stresses(coarse, types, tmp_path):
    dim, layer = (2, None) if types[0] == "CPS4" else (3, 4.0)
    for element in types:
        for suffix in (".inp", ".mesh"):
            coarse.write(tmp_path / f"a{suffix}", element=element, layer=layer)
        by_calculix, _ = pull_by_calculix(tmp_path, "a.inp", dim)
        by_mfem, _ = pull_by_mfem(tmp_path / "a.mesh")
        assert by_mfem.max() > 2 * PULL
        assert np.abs(by_calculix - by_mfem).max() < 0.01 * by_mfem.max()


def test_the_stress_concentration_is_that_of_the_handbook(long_plate, tmp_path):
    """Compare with Howland's plate of finite width, in Peterson's chart 4.1 by Heywood's fit."""
    rest = 1 - 16.0 / 40.0
    expected = (2 + 0.284 * rest - 0.6 * rest**2 + 1.32 * rest**3) / rest
    assert expected == pytest.approx(3.73, abs=0.005)
    for suffix in (".inp", ".mesh"):
        long_plate.write(tmp_path / f"a{suffix}", element="CPS8")
    _, by_calculix = pull_by_calculix(tmp_path, "a.inp", 2)
    _, by_mfem = pull_by_mfem(tmp_path / "a.mesh")
    assert by_calculix == pytest.approx(by_mfem, rel=0.01)
    assert by_calculix / PULL == pytest.approx(expected, rel=0.04)


def test_the_page_on_static_analysis_is_right(repository, tmp_path, monkeypatch):
    """Run its command and its job; the reactions are as it says."""
    page = (repository / "docs/static-analysis.md").read_text()
    command = page.partition("```bash\n")[2].partition("\n```")[0]
    job = page.partition("<!-- job -->\n```text\n")[2].partition("```\n<!-- end -->")[0]
    points, triangles = plate_surface()
    trimesh.Trimesh(points, triangles, process=False).export(tmp_path / "plate.stl")
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, shlex.split(command)[1:])
    assert done.exit_code == 0, done.output
    assert len(job.splitlines()) <= 20
    first, _, rest = job.partition("\n")
    assert first == "*INCLUDE, INPUT=plate.inp"
    printed = run_calculix(tmp_path, "plate.inp", rest)
    assert float(printed.split()[-3]) == pytest.approx(-32e3, rel=2e-3)
    table = pd.read_csv(tmp_path / "plate_sets.csv").set_index("name")
    assert table.loc["bolt", "kind"] == "hole"
    assert table.loc["bolt", "area"] == pytest.approx(2 * np.pi * 8 * 8, rel=0.02)
