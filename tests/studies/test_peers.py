"""Other meshers are measured correctly on known cases and cannot stop the workflow."""

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from needs import import_or_require
from shapes import box

import tusqh
from studies import peer_meshers
from studies.methods.raw_mesh import raw_mesh
from studies.methods.solids import cut_tets, describe_solid, measure_fit
from studies.peers import PEER_COLUMNS, compare_with_peers, run_peer
from tusqh.grid import BackgroundGrid
from tusqh.meshes.jacobians import element_volumes, smallest_jacobians
from tusqh.settings.model import Settings

#: A cube as five and as six tetrahedra.
CUBE = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
FIVE = np.array([[0, 1, 2, 4], [3, 2, 1, 7], [5, 4, 7, 1], [6, 7, 4, 2], [1, 2, 4, 7]])


def tets_of_cells(kept):
    """Return every kept cell as six conforming tetrahedra around its main diagonal."""
    mesh = raw_mesh(kept, BackgroundGrid(kept.shape, 1.0, (0.0, 0.0, 0.0)))
    ways = [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]]
    return mesh, mesh.cells[:, ways].reshape(-1, 4)


def gudhi_betti_of_tets(tets):
    import gudhi

    tree = gudhi.SimplexTree()
    for tet in tets.tolist():
        tree.insert(tet)
    tree.compute_persistence(persistence_dim_max=True)
    return tuple([*tree.betti_numbers(), 0, 0, 0][:3])


@given(seed=st.integers(0, 10**6), density=st.floats(0.2, 0.9))
@settings(max_examples=25, deadline=None, derandomize=True)
def test_tets_and_the_cells_they_cut_are_the_same_solid(seed, density):
    kept = np.random.default_rng(seed).random((3, 3, 3)) < density
    kept.flat[0] = True
    mesh, tets = tets_of_cells(kept)
    of_hexes = describe_solid(mesh.points, mesh.cells, cell_size=1.0)
    of_tets = describe_solid(mesh.points, tets, cell_size=1.0)
    assert of_hexes["manifold"] == of_tets["manifold"]
    assert of_hexes["volume"] == pytest.approx(kept.sum())
    assert of_tets["volume"] == pytest.approx(kept.sum())
    betti = tuple(of_hexes[f"betti_{k}"] for k in range(3))
    assert betti == gudhi_betti_of_tets(tets)
    if of_tets["manifold"]:
        assert betti == tuple(of_tets[f"betti_{k}"] for k in range(3))


def test_the_hexes_of_a_tet_are_positive_and_fill_it():
    mesh = cut_tets(CUBE, FIVE)
    assert mesh.n_cells == 20
    assert (smallest_jacobians(mesh.points, mesh.cells).determinant > 0).all()
    assert element_volumes(mesh.points, mesh.cells).sum() == pytest.approx(1)
    assert describe_solid(CUBE, FIVE, cell_size=1.0)["worst_scaled_jacobian"] > 0.3


def test_the_fit_of_a_box_in_a_larger_box():
    """The boundary of a unit cube in the middle of a cube of side 2 is half a unit inside."""
    cube = np.array([[0, 1, 3, 2, 4, 5, 7, 6]])
    fit = measure_fit(CUBE, cube, box((-0.5,) * 3, (1.5,) * 3))
    assert fit["boundary_mean"] == pytest.approx(0.5)
    assert fit["boundary_max"] == pytest.approx(0.5)
    assert 0.5 < fit["surface_mean"] < fit["surface_max"] < np.sqrt(0.75) + 1e-9
    same = measure_fit(CUBE, cube, box((0,) * 3, (1,) * 3))
    assert max(same.values()) < 1e-7


def run(peer, seconds=60, settings=None, policy=None, **changes):
    soup = box((0, 0, 0), (2, 1, 1))
    settings = {"grid": {"cells": 8}} | (settings or {})
    chosen = tusqh.mesh(soup, threshold=0.5, **settings["grid"], **(policy or {}))
    return run_peer(
        peer,
        soup,
        chosen.fractions,
        chosen.selection,
        settings=Settings.from_dict(settings),
        seconds=seconds,
        name="box",
        **changes,
    )


@pytest.mark.parametrize("peer", sorted(peer_meshers.PEERS))
def test_every_peer_meshes_a_box(peer):
    if peer in ("automesh", "pytetwild"):
        import_or_require(peer)
    row, timing = run(peer)
    assert row["status"] == "finished"
    assert list(row) == PEER_COLUMNS
    assert row["manifold"]
    assert (row["betti_0"], row["betti_1"], row["betti_2"]) == (1, 0, 0)
    assert row["worst_scaled_jacobian"] > 0.1
    assert row["boundary_max"] < 1.01
    # trimesh keeps every voxel that the surface touches; fitted edges give way to good elements.
    bound = {"trimesh": 2.0, "tusqh_fitted": 0.02}.get(peer, 0.01)
    assert abs(row["volume_error"]) < bound
    assert timing["seconds"] > 0
    assert timing["elements"] > 0


def test_our_mesh_is_the_one_of_the_pipeline():
    """All settings reach the peer called tusqh, including a policy and a window."""
    settings = {"grid": {"cells": 8}, "window": {"lower": [0, 0, 0], "upper": [1, 1, 1]}}
    row, timing = run("tusqh", settings=settings)
    assert timing["elements"] == 8**3
    assert row["status"] == "finished"


def test_a_missing_package_a_crash_an_error_and_a_hang_are_rows(tmp_path, monkeypatch):
    """The process reads a module of the peer's name from the first folder on its path."""
    package = tmp_path / "pytetwild.py"
    monkeypatch.setattr("studies.peers._PATIENCE", 3)
    outcomes = {
        "raise ModuleNotFoundError('no module pytetwild')": "not installed",
        "import os; os.kill(os.getpid(), 11)": "crashed with signal 11",
        "raise ValueError('no inside')": "failed: ValueError: no inside",
        "while True: pass": "not finished in 4 s",
        "import time; time.sleep(60)": "not finished in 4 s",
    }
    for text, status in outcomes.items():
        package.write_text(text)
        row, timing = run("pytetwild", seconds=4, python_path=[tmp_path])
        assert row["status"] == timing["status"] == status
        assert row["manifold"] is None
        assert np.isnan(timing["seconds"])


def test_the_summary_says_where_a_peer_is_better():
    ours = {"peer": "tusqh", "status": "finished", "manifold": True, "volume_error": 0.01}
    ours |= {"worst_scaled_jacobian": 0.577, "boundary_mean": 0.3, "surface_mean": 0.2}
    ours |= {"betti_0": 1, "betti_1": 0, "betti_2": 0}
    other = ours | {"peer": "other", "boundary_mean": 0.01, "manifold": False, "betti_1": 3}
    gone = dict.fromkeys(ours) | {"peer": "other", "status": "not installed"}
    rows = [{"model": m, **row} for m, row in (("a", ours), ("b", ours), ("a", other), ("b", gone))]
    summary = compare_with_peers(pd.DataFrame(rows)).set_index("peer")
    assert summary.loc["other", ["models", "finished", "manifold"]].tolist() == [2, 1, 0]
    assert summary.loc["other", ["nearer_boundary", "nearer_surface"]].tolist() == [1, 0]
    assert summary.loc["other", "same_topology"] == 0
    assert summary.loc["tusqh", ["finished", "manifold", "same_topology"]].tolist() == [2, 2, 2]
