"""Sets of facets and elements: holes, voids, parts, names by a place, elements and layers."""

import numpy as np
import pandas as pd
import pytest
import pyvista
import trimesh
from fields import noise_mesh
from plates import plate_outline

import tusqh
from studies.methods.creased_solids import SOLIDS
from tusqh.errors import ConfigError, MeshError
from tusqh.fitting.midpoints import mover_onto
from tusqh.geometry.soup import Soup
from tusqh.meshes.choose_sets import Wish, name_sets, table_of_sets
from tusqh.meshes.elements import Element
from tusqh.meshes.facets import HEX_FACETS
from tusqh.meshes.formats import Export, make_content, write_mesh
from tusqh.meshes.interfaces import facet_areas
from tusqh.meshes.jacobians import element_volumes
from tusqh.meshes.layer import extrude
from tusqh.meshes.patches import number_patches, read_patches, table_of_patches
from tusqh.meshes.quadratic import make_nodes
from tusqh.meshes.sets import find_sets
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.meshes.walls import divide_boundary
from tusqh.tables import write_csv


def mesh_of_cells(cells, origin=0.0):
    """Return the mesh of unit cells that are true in an array."""
    shape = np.array(cells.shape) + 1
    corner = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    if cells.ndim == 3:
        corner = np.array([[*row, z] for z in (0, 1) for row in corner.tolist()])
    at = np.argwhere(cells)[:, None, :] + corner
    used, numbered = np.unique(
        np.ravel_multi_index(np.moveaxis(at, -1, 0), shape), return_inverse=True
    )
    points = np.stack(np.unravel_index(used, shape), axis=1) + origin
    return VolumeMesh.from_arrays(points, numbered.reshape(at.shape[:2]))


def summary(mesh, **options):
    return {
        (f.name, f.kind): round(float(facet_areas(mesh.points, f.corners).sum()), 6)
        for f in find_sets(mesh, **options).once
        if f.kind != "plane"
    }


@pytest.mark.parametrize("dim", [2, 3])
def test_every_facet_is_in_one_set_and_holes_and_voids_are_counted(dim):
    for seed in range(6):
        rng = np.random.default_rng(seed)
        shape = (9, 8, 7)[:dim]
        mesh = noise_mesh(shape) if seed == 0 else mesh_of_cells(rng.random(shape) < 0.7)
        division = divide_boundary(mesh)
        rows = [wall.rows for wall in division.walls]
        on_planes = np.setdiff1d(np.flatnonzero(division.attribute <= 6), np.concatenate(rows))
        everything = np.concatenate([*rows, on_planes])
        assert np.array_equal(np.sort(everything), np.arange(len(mesh.boundary.corners)))
        sets = find_sets(mesh)
        once = [(e, k) for f in sets.once for e, k in zip(f.element, f.local, strict=True)]
        assert len(set(once)) == len(once) == len(mesh.boundary.corners)
        kinds = [found.kind for found in sets.facets]
        if mesh.measurement.is_manifold:
            betti = mesh.measurement.by_euler
            assert kinds.count("hole" if dim == 2 else "void") == tuple(betti)[dim - 1]
        n_parts = sum(block.kind == "part" for block in sets.blocks) or 1
        assert n_parts == mesh.measurement.by_boundary.betti_0
        sizes = [len(block.elements) for block in sets.blocks]
        assert sizes == sorted(sizes, reverse=True)
        assert len({found.number for found in sets.facets}) == len(sets.facets)
        assert len({found.name for found in sets.facets}) == len(sets.facets)


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("origin", [0.0, 4e6])
def test_a_block_with_holes_a_blind_hole_and_a_void(axis, origin):
    cells = np.ones((13, 9, 6), dtype=bool)
    cells[1:4, 1:4, :] = False  # A hole of 3 x 3, through 6 layers.
    cells[5:7, 1:3, :] = False  # A hole of 2 x 2.
    cells[8:10, 1:3, 3:] = False  # A blind hole of 2 x 2, 3 deep.
    cells[9, 6, 2] = False  # A void.
    cells[1:3, 6:, 4:] = False  # A notch at an edge.
    mesh = mesh_of_cells(np.moveaxis(cells, 2, axis), origin)
    assert summary(mesh) == {
        ("hole_1", "hole"): 12 * 6,
        ("hole_2", "hole"): 8 * 6,
        ("void_1", "void"): 6,
        ("recess_1", "recess"): 8 * 3 + 4,
        ("recess_2", "recess"): 2 * 3 + 2 * 3 * 2 + 2 * 2,
    }


def test_the_bore_of_a_pipe_is_a_hole_and_its_outside_is_not():
    places = np.indices((11, 11)) - 5
    square = (places**2).sum(axis=0)
    pipe = np.repeat(((square <= 27) & (square >= 6))[:, :, None], 4, axis=2)
    mesh = mesh_of_cells(pipe)
    found = summary(mesh)
    assert [kind for _, kind in found].count("hole") == 1
    assert found["hole_1", "hole"] == 4 * 4 * 5
    assert all(kind in ("hole", "wall", "recess") for _, kind in found)


@pytest.mark.parametrize("is_turned", [False, True])
@pytest.mark.parametrize("fit", [False, True])
def test_a_ring_has_the_wall_of_its_hole_inside(is_turned, fit):
    ring = trimesh.creation.torus(10, 3.5, major_sections=48, minor_sections=24)
    axis = np.array([0.0, 0.0, 1.0])
    if is_turned:
        turn = trimesh.transformations.rotation_matrix(0.7, [1, 1, 0.3])
        ring.apply_transform(turn)
        axis = turn[:3, :3] @ axis
    mesh = tusqh.mesh(ring, cells=14, betti=(1, 1, 0), fit=fit, name="ring").mesh
    holes = [f for f in find_sets(mesh, is_smooth=fit).once if f.kind == "hole"]
    assert [hole.name for hole in holes] == ["hole_1"]
    middle = mesh.points[holes[0].corners].mean(axis=1)
    away = np.linalg.norm(middle - np.outer(middle @ axis, axis), axis=1)
    assert away.max() < 11.5
    # The half of a torus that faces the axis has the area 2 pi r (pi R - 2 r).
    area = facet_areas(mesh.points, holes[0].corners).sum()
    assert 0.6 < area / (2 * np.pi * 3.5 * (np.pi * 10 - 7)) < 1.6


def test_sharp_edges_divide_a_fitted_boundary():
    """A plate that stands askew has no planes of its box, but its hole ends at sharp edges."""
    outline, segments = plate_outline(n=256)
    turn = np.array([[np.cos(0.3), -np.sin(0.3)], [np.sin(0.3), np.cos(0.3)]])
    found = tusqh.mesh((outline @ turn.T, segments), cell_size=2.0, fit=True, name="plate")
    sets = find_sets(found.mesh, is_smooth=True)
    lengths = {f.name: facet_areas(found.mesh.points, f.corners).sum() for f in sets.once}
    assert lengths.pop("hole_1") == pytest.approx(2 * np.pi * 8, rel=0.01)
    assert [*lengths.values()] == pytest.approx([60, 60, 40, 40], rel=0.01)


def test_a_set_is_named_by_a_place():
    cells = np.ones((13, 9, 3), dtype=bool)
    cells[1:6, 2:7], cells[8:9, 4:5] = False, False
    mesh = mesh_of_cells(cells)
    wishes = [Wish.read("big=near:3.5,4.5,1"), Wish.read("lid=plane:5,5,3")]
    sets = name_sets(mesh, find_sets(mesh), wishes)
    table = table_of_sets(mesh, sets).set_index("name")
    assert table.loc["big", "kind"] == "hole"
    assert table.loc["big", ["area", "x", "y", "z"]].tolist() == [60, 3.5, 4.5, 1.5]
    assert table.loc["hole_2", "area"] == 12
    assert table.loc["lid", ["kind", "number"]].tolist() == ["plane", 6]
    assert "hole_1" not in table.index
    assert table.loc["solid", "volume"] == cells.sum()
    assert pd.isna(table.loc["solid", "area"])


def test_wrong_wishes_are_refused():
    mesh = mesh_of_cells(np.ones((2, 2, 2), dtype=bool))
    sets = find_sets(mesh)
    for text in ("bolt", "bolt=near:1", "bolt=near:1,x,2", "bolt=screw:1,2,3", "a b=near:1,2,3"):
        with pytest.raises(ConfigError, match="NAME=near:X,Y,Z"):
            Wish.read(text)
    with pytest.raises(ConfigError, match="2 coordinates"):
        name_sets(mesh, sets, [Wish.read("a=near:1,2")])
    with pytest.raises(ConfigError, match="no set of the kind hole"):
        name_sets(mesh, sets, [Wish.read("a=hole:1,2,3")])
    with pytest.raises(ConfigError, match="called x_max already"):
        name_sets(mesh, sets, [Wish.read("x_max=near:0,1,1")])
    with pytest.raises(ConfigError, match="b and a name the same set"):
        name_sets(mesh, sets, [Wish.read("a=near:0,1,1"), Wish.read("b=near:0,1,1")])


def test_elements_that_a_mesh_or_a_format_does_not_have_are_refused(tmp_path):
    mesh = mesh_of_cells(np.ones((2, 2), dtype=bool))
    with pytest.raises(ConfigError, match="is for meshes in 3D"):
        Element.of("C3D20", 2)
    with pytest.raises(ConfigError, match="is not known"):
        Element.of("C3D9", 3)
    for suffix in ("inp", "bdf", "unv"):
        with pytest.raises(ConfigError, match="9 nodes"):
            write_mesh(tmp_path / f"a.{suffix}", mesh, export=Export(element="quad9"))
    for thickness in (0.0, -1.0, np.nan):
        with pytest.raises(ConfigError, match="thickness"):
            write_mesh(tmp_path / "a.msh", mesh, export=Export(layer=thickness))
    solid = mesh_of_cells(np.ones((2, 2, 2), dtype=bool))
    with pytest.raises(ConfigError, match="not plane"):
        write_mesh(tmp_path / "a.msh", solid, export=Export(layer=1.0))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("element", ["quad8", "quad9", "hex20", "hex27"])
def test_middle_nodes_lie_where_the_format_says(element, tmp_path):
    """VTK reads VTU and Exodus with the middle nodes in the middle of its own edges and faces."""
    far = noise_mesh((5, 4) if "quad" in element else (5, 4, 3))
    # VTK reads Exodus in single precision.
    mesh = VolumeMesh.from_arrays(far.points - far.points.min(axis=0), far.cells)
    export = Export(element=element)
    for suffix in ("vtu", "exo"):
        write_mesh(tmp_path / f"a.{suffix}", mesh, export=export)
        read = pyvista.read(tmp_path / f"a.{suffix}")
        if suffix == "exo":
            read = read["Element Blocks"].combine()
        n = int(element.removeprefix("quad").removeprefix("hex"))
        cells = np.asarray(read.cells).reshape(-1, n + 1)[:, 1:]
        points = np.asarray(read.points)[:, : mesh.dim]
        corners = cells[:, : 2**mesh.dim]
        assert element_volumes(points, corners).sum() == pytest.approx(mesh.volumes.sum(), rel=1e-5)
        found = points[cells]
        nodes = make_nodes(VolumeMesh.from_arrays(points, corners), Element.of(element, mesh.dim))
        expected = nodes.points[nodes.cells]
        assert np.allclose(found, expected, rtol=0, atol=1e-6)


def test_middle_nodes_lie_on_the_geometry_and_no_element_is_inverted():
    ball = trimesh.creation.icosphere(subdivisions=5, radius=10)
    found = tusqh.mesh(ball, cells=10, betti=(1, 0, 0), fit=True, name="ball")
    mover = mover_onto(found.geometry)
    nodes = make_nodes(found.mesh, Element.of("hex20", 3), mover)
    n = len(found.mesh.points)
    local = Element.of("hex20", 3).facets[found.mesh.boundary.local]
    on_facets = np.take_along_axis(nodes.cells[found.mesh.boundary.element], local, axis=1)
    middle = np.unique(on_facets[:, 4:])
    assert (middle >= n).all()
    away = np.abs(np.linalg.norm(nodes.points[middle], axis=1) - 10)
    straight = make_nodes(found.mesh, Element.of("hex20", 3))
    before = np.abs(np.linalg.norm(straight.points[middle], axis=1) - 10)
    assert nodes.n_moved >= 0.95 * len(middle)
    assert np.median(away) < 0.3 * np.median(before)
    inner = np.setdiff1d(np.arange(len(nodes.points)), middle)
    assert np.array_equal(nodes.points[inner], straight.points[inner])


def test_a_middle_node_on_a_sharp_edge_moves_to_a_sharp_edge():
    box = trimesh.creation.box((2, 2, 2))
    soup = Soup(np.asarray(box.vertices), np.asarray(box.faces), np.zeros(12, dtype=int))
    move = mover_onto(soup)
    places = np.array([[0.95, 0.9, 0.2], [0.95, 0.9, 0.2], [0.5, 0.2, 0.2]])
    moved = move(places, np.array([True, False, False]), np.full(3, 0.3))
    assert np.allclose(moved, [[1, 1, 0.2], [1, 0.9, 0.2], [0.5, 0.2, 0.2]])


def test_a_layer_has_the_sets_of_its_quads():
    mesh = noise_mesh((5, 4))
    plane = find_sets(mesh)
    hexes, solid = extrude(mesh, plane, 0.25)
    assert hexes.volumes.sum() == pytest.approx(0.25 * mesh.volumes.sum())
    assert hexes.measurement.is_sound
    areas = {f.name: facet_areas(hexes.points, f.corners).sum() for f in solid.facets}
    for found in plane.facets:
        length = facet_areas(mesh.points, found.corners).sum()
        assert areas[found.name] == pytest.approx(0.25 * length)
    assert areas["front"] == areas["back"] == pytest.approx(mesh.volumes.sum())
    for found in solid.facets:
        corners = hexes.cells[found.element[:, None], HEX_FACETS[found.local]]
        assert np.array_equal(corners, found.corners)
    once = [(e, k) for f in solid.once for e, k in zip(f.element, f.local, strict=True)]
    assert len(set(once)) == len(once) == len(hexes.boundary.corners)


def test_each_face_of_a_turned_solid_is_a_patch():
    """Every patch of two overlapping boxes is plane, and together they are the whole boundary."""
    solid = SOLIDS["two_boxes"][0]().turned(2)
    result = tusqh.mesh((solid.points, solid.triangles), cells=20, threshold=0.5, fit=True)
    content = make_content(result.mesh, None, result.export())
    patches = [found for found in content.sets.facets if found.kind == "patch"]
    assert [found.name for found in patches] == [f"patch_{k}" for k in range(1, 13)]
    areas = [facet_areas(result.mesh.points, found.corners).sum() for found in patches]
    assert areas == sorted(areas, reverse=True)
    assert sum(len(found.element) for found in patches) == len(result.mesh.boundary.element)
    size = result.fractions.grid.cell_size
    for found in patches:
        places = result.mesh.points[np.unique(found.corners)]
        off = np.linalg.svd(places - places.mean(axis=0))[1][2] / np.sqrt(len(places))
        assert off < 0.15 * size


def test_sides_between_corners_are_patches_in_the_plane():
    ends = np.array([[0, 0], [3, 0.3], [2.7, 3.3], [-0.3, 3]])
    lines = [[0, 1], [1, 2], [2, 3], [3, 0]]
    result = tusqh.mesh((ends, lines), cells=16, threshold=0.5, fit=True)
    content = make_content(result.mesh, None, result.export())
    patches = [found for found in content.sets.facets if found.kind == "patch"]
    lengths = [facet_areas(result.mesh.points, found.corners).sum() for found in patches]
    assert np.allclose(lengths, np.hypot(3, 0.3), rtol=0.01)
    assert len(patches) == 4


def test_the_table_of_patches_gives_the_patches_again(tmp_path):
    mesh = tusqh.mesh(np.ones((2, 2, 2)), cells=2, threshold=0.5).mesh
    patch = np.where(mesh.boundary.attribute == 3, -1, mesh.boundary.attribute)
    write_csv(tmp_path / "patches.csv", table_of_patches(mesh, patch))
    assert (read_patches(tmp_path / "patches.csv", mesh) == number_patches(mesh, patch)).all()
    (tmp_path / "patches.csv").write_text("element,facet,patch\n70,1,1\n")
    with pytest.raises(MeshError, match="not a table of the patches of this mesh"):
        read_patches(tmp_path / "patches.csv", mesh)
