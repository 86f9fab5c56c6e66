"""Background meshes from files, and those that are refused."""

import meshio
import numpy as np
import pytest
from backgrounds import backgrounds, ring_of_three

from tusqh.background.background_mesh import BackgroundMesh
from tusqh.background.checks import require_background, require_overlap
from tusqh.background.makers import make_box, make_cylinder, make_layers
from tusqh.background.reading import read_background
from tusqh.errors import ConfigError, MeshError
from tusqh.geometry.outline import Outline
from tusqh.meshes.formats import write_mesh
from tusqh.meshes.volume_mesh import VolumeMesh


def as_mesh(background):
    return VolumeMesh.from_arrays(background.points, background.cells, name=background.name)


@pytest.mark.parametrize("suffix", [".vtu", ".msh", ".exo", ".inp", ".mesh"])
@pytest.mark.parametrize("name", ["cylinder", "triangles"])
def test_files_that_tusqh_writes_are_read_as_they_were(tmp_path, suffix, name):
    background = backgrounds()[name]
    path = tmp_path / f"background{suffix}"
    write_mesh(path, as_mesh(background))
    found = read_background(path)
    assert found.cells.shape == background.cells.shape
    places = found.points[found.cells], background.points[background.cells]
    # Formats may order elements by sets; their corners stay together.
    ordered = [p.reshape(len(p), -1)[np.lexsort(p.mean(axis=1).round(6).T)] for p in places]
    assert np.allclose(*ordered, atol=1e-9)


def write(path, points, blocks):
    meshio.write_points_cells(path, points, blocks)
    return path


def spread(background):
    """Return points with three coordinates."""
    return np.pad(background.points, ((0, 0), (0, 3 - background.dim)))


def test_boundary_elements_unused_points_and_turned_cells_are_remarked(tmp_path):
    box = make_box((0, 0, 0), (1, 1, 1), (2, 2, 2))
    points = np.vstack([box.points, [[9.0, 9.0, 9.0]]])
    turned = box.cells[:, [4, 5, 6, 7, 0, 1, 2, 3]]
    blocks = [("hexahedron", turned), ("quad", box.facets.boundary), ("line", np.array([[0, 1]]))]
    found = read_background(write(tmp_path / "box.vtu", points, blocks))
    assert (found.n_cells, found.n_points) == (8, 27)
    assert [(r.effect, r.count) for r in found.remarks] == [
        ("left out", 25),
        ("left out", 1),
        ("changed", 8),
    ]
    assert found.jacobians.scaled.min() == 1.0


def tetrahedron():
    return np.array([[0, 1, 2, 8]])


@pytest.mark.parametrize(
    ("blocks", "message"),
    [
        ([("tetra", tetrahedron())], "8 hexahedron, 1 tetra"),
        ([("wedge", np.array([[0, 1, 2, 8, 9, 10]]))], "8 hexahedron, 1 wedge"),
    ],
)
def test_mixed_meshes_are_refused_with_counts(tmp_path, blocks, message):
    box = make_box((0, 0, 0), (1, 1, 1), (2, 2, 2))
    path = write(tmp_path / "mixed.vtu", box.points, [("hexahedron", box.cells), *blocks])
    with pytest.raises(MeshError, match=message):
        read_background(path)


def test_files_that_hold_no_background_are_refused(tmp_path):
    disc = make_cylinder((0, 0), 1.0)
    triangles = write(tmp_path / "t.vtu", spread(disc), [("triangle", disc.cells[:, :3])])
    curved = np.column_stack([disc.points, disc.points[:, 0] ** 2])
    bent = write(tmp_path / "bent.vtu", curved, [("quad", disc.cells)])
    damaged = tmp_path / "damaged.vtu"
    damaged.write_bytes(triangles.read_bytes()[:300])
    text = tmp_path / "points.xyz"
    text.write_text("0 0 0")
    hanging = tmp_path / "hanging.mesh"
    hanging.write_text("MFEM mesh v1.1\n\ndimension\n2\n")
    cut = tmp_path / "cut.mesh"
    cut.write_text("MFEM mesh v1.0\n\ndimension\n2\n\nelements\n3\n1 3 0 1 2 3\n")
    for path, message in (
        (triangles, "132 triangle"),
        (bent, "quads with z from"),
        (damaged, "cannot be read as vtu"),
        (text, "no suffix of a mesh"),
        (tmp_path / "nothing.vtu", "no such file"),
        (hanging, "v1.1"),
        (cut, "damaged"),
    ):
        with pytest.raises(MeshError, match=message):
            read_background(path)


def refused(points, cells):
    with pytest.raises(MeshError) as error:
        require_background(BackgroundMesh(np.asarray(points, dtype=float), np.asarray(cells)))
    assert error.value.remedy
    return str(error.value)


@pytest.mark.parametrize("dim", [2, 3])
def test_faults_of_a_background_are_named_with_their_place(dim):
    box = make_box((0,) * dim, (3,) * dim, (3,) * dim)
    require_background(box)
    points, cells = box.points, box.cells
    twice = cells.copy()
    twice[1, 0] = twice[1, 1]
    assert "the first is cell 1 near" in refused(points, twice)
    assert "repeated, the first is cell" in refused(points, np.vstack([cells, cells[:1]]))
    apart = np.vstack([points, points[cells[0]]])
    moved = cells.copy()
    moved[0] = len(points) + np.arange(2**dim)
    assert "points are repeated" in refused(apart, moved)
    folded = points.copy()
    folded[cells[0, 2]] = folded[cells[0, 0]] - 0.5
    assert "inverted, the first is cell 0" in refused(folded, cells)
    flat = points.copy()
    flat[:, -1] *= 1e-6
    flat[:, 0] += flat[:, -1] * 1e6
    assert "flat" in refused(flat, cells) or dim == 3


def test_hanging_vertices_are_refused():
    coarse = make_box((0, 0), (2, 2), (1, 1))
    fine = make_box((2, 0), (3, 2), (1, 2))
    points, number = np.unique(np.vstack([coarse.points, fine.points]), axis=0, return_inverse=True)
    cells = number.ravel()[np.vstack([coarse.cells, fine.cells + len(coarse.points)])]
    assert "1 vertices hang on sides or edges of other cells, the first at (2, 1)" in refused(
        points, cells
    )


def test_two_quads_that_share_two_sides_are_refused():
    points = [[0, 0], [2, 0], [2, 2], [0, 2], [1, 1]]
    cells = [[0, 1, 2, 4], [4, 2, 3, 0]]
    assert "share two sides" in refused(points, cells)


def test_cells_that_touch_in_a_vertex_or_an_edge_only_are_refused():
    box = make_box((0, 0), (2, 2), (2, 2))
    both = box.cells[[0, 3]]
    used = np.unique(both)
    number = np.zeros(box.n_points, dtype=int)
    number[used] = np.arange(len(used))
    assert "at 1 vertices the cells are not one fan" in refused(box.points[used], number[both])
    block = make_box((0, 0, 0), (2, 2, 2), (2, 2, 2))
    for pair, message in (((0, 6), "at 1 edges"), ((0, 7), "at 1 vertices")):
        both = block.cells[list(pair)]
        used = np.unique(both)
        number = np.zeros(block.n_points, dtype=int)
        number[used] = np.arange(len(used))
        assert message in refused(block.points[used], number[both])


def test_a_background_in_another_unit_or_place_is_refused():
    square = Outline.from_chains([np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])])
    require_overlap(make_box((0, 0), (2, 2), (4, 4)), square)
    for background, message in (
        (make_box((0, 0), (1000, 1000), (4, 4)), "1e.03 times as large as the geometry"),
        (make_box((0, 0), (0.001, 0.001), (4, 4)), "0.001 times as large"),
        (make_box((5, 5), (6, 6), (4, 4)), "misses the geometry"),
        (make_box((0, 0, 0), (1, 1, 1), (2, 2, 2)), "a mesh in 3D, and the geometry is in 2D"),
    ):
        with pytest.raises(MeshError, match=message):
            require_overlap(background, square)


def test_makers_make_valid_backgrounds_or_explain():
    for background in (
        make_layers((0, 0, 0), (1, 1, 1), (2, 2, 8), growth=1.4),
        make_cylinder((0, 0, 1), 2.0, 5.0, core=4, rings=3, layers=2),
        ring_of_three(),
    ):
        require_background(background)
    cylinder = make_cylinder((1, 2, 3), 2.0, 5.0, core=16, rings=8, layers=2)
    assert np.isclose(cylinder.volumes.sum(), 5 * 4 * np.pi, rtol=0.02)
    for wrong in (
        lambda: make_box((0, 0), (1, 0), (2, 2)),
        lambda: make_box((0, 0), (1, 1), (2, 2, 2)),
        lambda: make_layers((0, 0), (1, 1), (2, 2), growth=0),
        lambda: make_cylinder((0, 0), 1.0, 2.0),
        lambda: make_cylinder((0, 0), -1.0),
    ):
        with pytest.raises(ConfigError):
            wrong()


def test_the_digest_depends_on_points_and_cells_alone():
    box = make_box((0, 0), (1, 1), (2, 2))
    assert box.digest == make_box((0, 0), (1, 1), (2, 2), unit="mm").digest
    assert box.digest != make_box((0, 0), (1, 1), (2, 3)).digest
    assert box.digest != BackgroundMesh(box.points, np.roll(box.cells, 1, axis=1)).digest
