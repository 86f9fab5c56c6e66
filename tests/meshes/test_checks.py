"""Every check fails on the mesh made for it, and passes on all others."""

import numpy as np
import pytest

from tusqh.errors import MeshError, SimulationError
from tusqh.meshes.betti import betti_by_boundary, betti_by_euler
from tusqh.meshes.checks import CONFORMITY, check_mesh
from tusqh.meshes.export import read_vtu, write_vtu
from tusqh.meshes.volume_mesh import VolumeMesh

SQUARE = [[0.0, 0], [1, 0], [1, 1], [0, 1]]


def lattice(shape, picked):
    """Return quads of a lattice of unit cells, without unused points."""
    nx, ny = shape
    corners = np.array(
        [
            [
                i * (ny + 1) + j,
                (i + 1) * (ny + 1) + j,
                (i + 1) * (ny + 1) + j + 1,
                i * (ny + 1) + j + 1,
            ]
            for i, j in picked
        ]
    )
    points = np.array([[x, y] for x in range(nx + 1) for y in range(ny + 1)], dtype=float)
    used, cells = np.unique(corners, return_inverse=True)
    return points[used], cells.reshape(-1, 4)


BAD = {
    "indices_out_of_range": (SQUARE, [[0, 1, 2, 9]]),
    "non_finite_points": ([*SQUARE[:3], [0, np.nan]], [[0, 1, 2, 3]]),
    "unused_points": ([*SQUARE, [5, 5]], [[0, 1, 2, 3]]),
    "repeated_corners": (SQUARE, [[0, 1, 2, 2], [0, 1, 2, 3]]),
    "repeated_points": (
        [*SQUARE, [1, 0], [2, 0], [2, 1], [1, 1]],
        [[0, 1, 2, 3], [4, 5, 6, 7]],
    ),
    "repeated_elements": (SQUARE, [[0, 1, 2, 3], [1, 2, 3, 0]]),
    "overfull_facets": (
        [*SQUARE, [2, 0], [2, 1], [2, -1], [2, 2]],
        [[0, 1, 2, 3], [1, 4, 5, 2], [1, 6, 7, 2]],
    ),
    "hanging_nodes": (
        [[0, 0], [2, 0], [2, 2], [0, 2], [3, 0], [3, 1], [2, 1]],
        [[0, 1, 2, 3], [1, 4, 5, 6]],
    ),
    "non_manifold_points": lattice((2, 2), [(0, 0), (1, 1)]),
    "non_positive_jacobians": (
        [[0, 0], [1, 0], [0.2, 0.2], [0, 1]],
        [[0, 1, 2, 3]],
    ),
}


@pytest.mark.parametrize("identifier", BAD)
def test_each_check_fires(identifier):
    points, cells = BAD[identifier]
    mesh = VolumeMesh.from_arrays(np.array(points, float), np.array(cells), name="my model")
    failed = {check.id: check for check in check_mesh(mesh) if not check.holds}
    assert identifier in failed
    measured = mesh.measurement
    assert not measured.is_sound
    assert measured.is_conforming == (not CONFORMITY & set(failed))
    with pytest.raises(MeshError, match=f"my model: .*{failed[identifier].name}"):
        measured.require_sound()
    with pytest.raises(SimulationError, match="the mesh of 'my model' cannot be simulated on"):
        mesh.to_mfem()


def test_a_mesh_remembers_what_is_known_about_it():
    mesh = VolumeMesh.from_arrays(np.array(SQUARE), [[0, 1, 2, 3]])
    for name in ("facets", "boundary", "jacobians", "volumes", "measurement"):
        assert getattr(mesh, name) is getattr(mesh, name)
    assert mesh.measurement.checks is mesh.measurement.checks
    assert mesh.measurement.is_manifold
    assert mesh.measurement.smallest_scaled_jacobian == mesh.measurement.volume == 1


def test_flat_elements_are_found():
    flat = VolumeMesh.from_arrays(np.array([[0.0, 0], [1, 0], [2, 0], [0, 1]]), [[0, 1, 2, 3]])
    assert not check_mesh(flat)[-1].holds


@pytest.mark.parametrize(
    ("picked", "expected"),
    [
        ([(0, 0)], (1, 0, 0)),
        ([(0, 0), (2, 2)], (2, 0, 0)),
        ([(i, j) for i in range(3) for j in range(3) if (i, j) != (1, 1)], (1, 1, 0)),
    ],
)
def test_betti_numbers_by_hand(picked, expected, tmp_path):
    mesh = VolumeMesh.from_arrays(*lattice((3, 3), picked), name="by hand")
    assert betti_by_euler(mesh) == betti_by_boundary(mesh) == expected
    native = mesh.to_mfem()
    n_edges = native.GetNEdges()
    assert native.GetNV() - n_edges + native.GetNE() == expected[0] - expected[1]
    path = tmp_path / "mesh.vtu"
    write_vtu(path, mesh)
    again = read_vtu(path)
    assert np.array_equal(again.points, mesh.points)
    assert np.array_equal(again.cells, mesh.cells)
    first = path.read_bytes()
    write_vtu(path, mesh)
    assert path.read_bytes() == first


def test_unreadable_meshes(tmp_path):
    with pytest.raises(MeshError, match="no such file"):
        read_vtu(tmp_path / "gone.vtu")
    broken = tmp_path / "broken.vtu"
    broken.write_text("this is not XML")
    with pytest.raises(MeshError):
        read_vtu(broken)
