import numpy as np
import pytest
from needs import import_or_require

from tusqh.meshes.jacobians import element_volumes, smallest_jacobians
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.pipeline.judge import judge
from tusqh.quality.elements import element_metrics, summarise_metrics
from tusqh.quality.surface import judge_surface, surface_measures
from tusqh.quality.system_libraries import SystemLibraryError, check_rendering, describe_missing
from tusqh.quality.verdict import judge_mesh, overall, to_table
from tusqh.topology.betti_numbers import BettiNumbers


def lattice(n, picked, shift=(0.0, 0.0)):
    corners = np.array(
        [[i * (n + 1) + j, (i + 1) * (n + 1) + j, (i + 1) * (n + 1) + j + 1, i * (n + 1) + j + 1]
         for i, j in picked]
    )  # fmt: skip
    points = np.array([[x, y] for x in range(n + 1) for y in range(n + 1)], dtype=float)
    used, cells = np.unique(corners, return_inverse=True)
    return VolumeMesh.from_arrays(points[used] + shift, cells.reshape(-1, 4))


ANNULUS = [(i, j) for i in range(3) for j in range(3) if (i, j) != (1, 1)]


def test_vtk_agrees_with_our_scaled_jacobian_far_from_the_origin():
    rng = np.random.default_rng(0)
    mesh = lattice(6, [(i, j) for i in range(6) for j in range(6)])
    points = mesh.points + rng.uniform(-0.2, 0.2, mesh.points.shape)
    for shift in (0.0, 4.0e6):
        moved = VolumeMesh.from_arrays(points + shift, mesh.cells)
        metrics = element_metrics(moved)
        ours = smallest_jacobians(moved.points, moved.cells)[1]
        assert metrics["scaled_jacobian"].to_numpy() == pytest.approx(ours, abs=1e-8)
        summary = summarise_metrics(metrics).set_index("metric")
        area = element_volumes(moved.points, moved.cells)
        assert summary.loc["area", "mean"] == pytest.approx(area.mean(), abs=1e-6)
        assert summary.loc["min_angle", "unit"] == "degree"


@pytest.mark.parametrize(
    ("picked", "components", "loops", "pinches"),
    [
        ([(0, 0)], 1, 1, 0),
        (ANNULUS, 1, 2, 0),
        ([(0, 0), (2, 2)], 2, 2, 0),
        ([(0, 0), (1, 1)], 2, -1, 1),
    ],
)
def test_pymeshlab_by_hand(picked, components, loops, pinches):
    import_or_require("pymeshlab")
    measures = surface_measures(lattice(3, picked, shift=(4e5, 4e6)))
    assert measures.connected_components == components
    assert measures.boundary_loops == loops
    assert measures.non_manifold_vertices == pinches
    assert measures.non_manifold_edges == 0


def test_a_sound_mesh_is_suitable_and_a_wrong_prediction_is_not():
    import_or_require("pymeshlab")
    mesh = lattice(3, ANNULUS)
    right = to_table(judge_mesh(mesh, BettiNumbers(1, 1), element_metrics(mesh)))
    assert overall(right) == "suitable"
    wrong = to_table(judge_mesh(mesh, BettiNumbers(1, 0), element_metrics(mesh)))
    assert overall(wrong) == "not suitable: 3 checks fail"
    pinched = lattice(3, [(0, 0), (1, 1)])
    assert overall(
        to_table(judge_mesh(pinched, BettiNumbers(1, 0), element_metrics(pinched)))
    ).startswith("not suitable")


def test_overlapping_elements_are_found():
    points = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2], [1, 0.5], [3, 0.5], [3, 1.5], [1, 1.5]])
    mesh = VolumeMesh.from_arrays(points, [[0, 1, 2, 3], [4, 5, 6, 7]])
    table = to_table(judge_mesh(mesh, BettiNumbers(2, 0), element_metrics(mesh)))
    assert table[table["holds"] == "no"]["id"].tolist() == ["overlap"]


def test_a_missing_system_library_costs_pymeshlabs_rows_only(monkeypatch):
    def load(name):
        if name == "libGL.so.1":
            raise OSError(name)

    monkeypatch.setattr("ctypes.CDLL", load)
    monkeypatch.setattr("sys.platform", "linux")
    assert describe_missing().startswith("libGL.so.1 not found, needed for pymeshlab's checks")
    assert "apt-get install libgl1)" in describe_missing()

    def fail(mesh):
        raise SystemLibraryError("pymeshlab cannot run", where="", expected="", remedy="")

    table = to_table(judge_surface(lattice(3, ANNULUS), BettiNumbers(1, 1), fail))
    assert set(table["holds"]) == {"not run"}
    assert overall(table) == "suitable (6 not run)"


def test_rendering_without_a_library_is_an_error_with_a_remedy(monkeypatch):
    def load(name):
        raise OSError(name)

    monkeypatch.setattr("ctypes.CDLL", load)
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    with pytest.raises(SystemLibraryError, match="apt-get install libgl1 libx11-6 libegl1"):
        check_rendering()
    monkeypatch.setenv("DISPLAY", ":0")
    check_rendering()


def test_other_programs_leave_out_large_meshes_unless_they_are_asked(monkeypatch):
    monkeypatch.setattr("tusqh.pipeline.judge.MOST_ELEMENTS", 7)
    judgement = judge(lattice(3, ANNULUS), BettiNumbers(1, 1))
    assert str(judgement) == "suitable (3 not run)"
    left_out = judgement.verdict[judgement.verdict["holds"] == "not run"]
    assert set(left_out["found"]) == {"not run: 8 elements; `--all-checks` runs them"}
    everything = judge(lattice(3, ANNULUS), BettiNumbers(1, 1), checks="all").verdict
    assert not everything["id"].str.startswith("checks_by_").any()
    assert len(everything) > len(judgement.verdict)
