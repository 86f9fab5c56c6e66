"""Every format is read back by another library and compared."""

import re

import meshio
import mfem.ser as mfem
import netCDF4
import numpy as np
import pandas as pd
import pytest
import pyvista
from fields import noise_mesh

from tusqh.errors import MeshError
from tusqh.meshes.boundary import SIDES
from tusqh.meshes.facets import HEX_FACETS
from tusqh.meshes.formats import write_beside, write_mesh
from tusqh.meshes.sets import find_sets
from tusqh.meshes.volume_mesh import VolumeMesh


@pytest.fixture(params=[2, 3], ids=["quads", "hexes"])
def mesh(request):
    return noise_mesh((5, 4, 3)[: request.param])


def padded(points):
    out = np.zeros((len(points), 3))
    out[:, : points.shape[1]] = points
    return out


def test_every_facet_is_in_the_set_of_its_plane_or_of_its_direction(mesh):
    boundary = mesh.boundary
    centre = mesh.points[mesh.cells].mean(axis=1)[boundary.element]
    places = mesh.points[boundary.corners]
    away = places.mean(axis=1) - centre
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    for axis in range(mesh.dim):
        for side, (sign, end) in enumerate(((-1, low), (1, high))):
            on_box = boundary.attribute == 2 * axis + side + 1
            elsewhere = boundary.attribute == 2 * axis + side + 7
            for members in (on_box, elsewhere):
                assert (sign * away[members, axis] > 0).all()
                flat = places[members][..., axis]
                assert np.allclose(flat, flat[:, :1], rtol=1e-9)
            in_plane = np.isclose(places[..., axis], end[axis], rtol=1e-9).all(axis=1)
            assert np.array_equal(on_box, in_plane)
    assert (boundary.attribute == len(SIDES)).any()
    if mesh.dim == 3:
        corners = mesh.cells[boundary.element][:, HEX_FACETS]
        assert np.array_equal(corners[np.arange(len(corners)), boundary.local], boundary.corners)


def test_the_walls_of_a_hole_are_not_in_the_sides_of_the_box():
    places = [(i, j) for i in range(3) for j in range(3) if (i, j) != (1, 1)]
    points = np.array([[x, y] for x in range(4) for y in range(4)], dtype=float)
    cells = np.array([[4 * i + j, 4 * i + j + 4, 4 * i + j + 5, 4 * i + j + 1] for i, j in places])
    boundary = VolumeMesh.from_arrays(points, cells).boundary
    found = dict(zip(*np.unique(boundary.attribute, return_counts=True), strict=True))
    names = {SIDES[k - 1]: int(n) for k, n in found.items()}
    walls = {f"normal_{a}_{d}": 1 for a in "xy" for d in ("minus", "plus")}
    assert names == {"x_min": 3, "x_max": 3, "y_min": 3, "y_max": 3, **walls}


def expected_sets(mesh, *, once):
    """Return the facets of every set, as sets of corners."""
    sets = find_sets(mesh)
    chosen = sets.once if once else sets.facets
    return {f.name: {frozenset(row) for row in f.corners.tolist()} for f in chosen}


def facets_of(corners):
    return {frozenset(row) for row in np.asarray(corners).tolist()}


def test_mfem_reads_its_own_format(mesh, tmp_path):
    write_mesh(tmp_path / "mesh.mesh", mesh)
    native = mfem.Mesh(str(tmp_path / "mesh.mesh"), 1, 0, False)
    assert (native.GetNV(), native.GetNE()) == (len(mesh.points), mesh.n_cells)
    assert native.CheckElementOrientation(False) == 0
    assert native.GetNBE() == len(mesh.boundary.corners)
    text = (tmp_path / "mesh.mesh").read_text()
    names = dict(re.findall(r"^# (\d+) (\w+): ", text, re.MULTILINE))
    found = {name: set() for name in names.values()}
    for k in range(native.GetNBE()):
        name = names[str(native.GetBdrAttribute(k))]
        found[name].add(frozenset(native.GetBdrElement(k).GetVerticesArray()))
    assert found == expected_sets(mesh, once=True)
    vertices = np.array(native.GetVertexArray()).reshape(native.GetNV(), -1)[:, : mesh.dim]
    assert np.array_equal(vertices, mesh.points)


def test_meshio_reads_gmsh(mesh, tmp_path):
    write_mesh(tmp_path / "mesh.msh", mesh)
    back = meshio.read(tmp_path / "mesh.msh")
    assert np.array_equal(back.points, padded(mesh.points))
    kind, side = ("quad", "line") if mesh.dim == 2 else ("hexahedron", "quad")
    cells, groups = back.get_cells_type(kind), back.get_cell_data("gmsh:physical", kind)
    number = {name: int(tag) for name, (tag, dim) in back.field_data.items() if dim == mesh.dim}
    for block in find_sets(mesh).blocks:
        assert np.array_equal(cells[groups == number[block.name]], mesh.cells[block.elements])
    corners, tags = back.get_cells_type(side), back.get_cell_data("gmsh:physical", side)
    number = {name: int(tag) for name, (tag, dim) in back.field_data.items() if dim < mesh.dim}
    found = {name: facets_of(corners[tags == tag]) for name, tag in number.items()}
    assert found == expected_sets(mesh, once=True)
    assert (tmp_path / "mesh.msh").read_text("ascii").startswith("$MeshFormat\n2.2 0 8\n")


EXODUS_FACES = [(1, 2, 6, 5), (2, 3, 7, 6), (3, 4, 8, 7), (4, 1, 5, 8), (1, 4, 3, 2), (5, 6, 7, 8)]
QUAD_SIDES = [(1, 2), (2, 3), (3, 4), (4, 1)]


def read_names(file, variable):
    return [bytes(np.ma.filled(row, b"")).rstrip(b"\0").decode() for row in file[variable][:]]


def test_exodus_has_all_sets(mesh, tmp_path):
    write_mesh(tmp_path / "mesh.exo", mesh)
    back = meshio.read(tmp_path / "mesh.exo")
    assert np.array_equal(back.points[:, : mesh.dim], mesh.points)
    cells = np.concatenate([block.data for block in back.cells])
    sets = find_sets(mesh)
    order = np.concatenate([block.elements for block in sets.blocks])
    assert np.array_equal(cells, mesh.cells[order])
    sides = np.array(QUAD_SIDES if mesh.dim == 2 else EXODUS_FACES) - 1
    with netCDF4.Dataset(tmp_path / "mesh.exo") as file:
        assert file.dimensions["num_dim"].size == mesh.dim
        assert read_names(file, "eb_names") == [block.name for block in sets.blocks]
        assert file["eb_prop1"][:].tolist() == [block.number for block in sets.blocks]
        assert file["ss_prop1"][:].tolist() == [found.number for found in sets.facets]
        found, points = {}, {}
        for k, name in enumerate(read_names(file, "ss_names"), start=1):
            own, side = file[f"elem_ss{k}"][:] - 1, file[f"side_ss{k}"][:] - 1
            found[name] = facets_of(np.take_along_axis(cells[own], sides[side], axis=1))
        for k, name in enumerate(read_names(file, "ns_names"), start=1):
            points[name] = set((file[f"node_ns{k}"][:] - 1).tolist())
    assert found == expected_sets(mesh, once=False)
    assert points == {name: set().union(*facets) for name, facets in found.items()}
    assert pyvista.read(tmp_path / "mesh.exo")["Element Blocks"].combine().n_cells == mesh.n_cells


def parse_abaqus(path):
    """Return the entries of every set of an input file, by keyword and name."""
    found, key = {}, None
    for line in path.read_text().splitlines():
        if line.startswith("**"):
            continue
        if line.startswith("*"):
            word, _, rest = line.partition(", ")
            name = re.search(r"(?:ELSET|NSET|NAME)=(\w+)", rest)
            key = (word, name[1] if name else "")
            found[key] = []
        else:
            found[key].append(line.rstrip(", ").split(", "))
    return found


def test_abaqus_has_all_sets(mesh, tmp_path):
    write_mesh(tmp_path / "mesh.inp", mesh)
    back = meshio.read(tmp_path / "mesh.inp")
    assert np.allclose(back.points, padded(mesh.points), rtol=1e-12, atol=1e-12)
    faces = [(1, 2, 3, 4), (5, 8, 7, 6), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 8, 4), (4, 8, 5, 1)]
    sides = QUAD_SIDES if mesh.dim == 2 else faces
    found, points = {}, {}
    parsed = parse_abaqus(tmp_path / "mesh.inp")
    for (word, name), rows in parsed.items():
        if word == "*SURFACE":
            corners = [
                mesh.cells[int(element) - 1][np.array(sides[int(side[1:]) - 1]) - 1]
                for element, side in rows
            ]
            found[name] = facets_of(corners)
        elif word == "*NSET":
            points[name] = {int(node) - 1 for row in rows for node in row}
    assert found == expected_sets(mesh, once=False)
    assert points == {name: set().union(*facets) for name, facets in found.items()}
    sets = find_sets(mesh)
    for block in sets.blocks:
        rows = np.array(parsed["*ELEMENT", block.name], dtype=int) - 1
        assert np.array_equal(rows[:, 0], block.elements)
        assert np.array_equal(rows[:, 1:], mesh.cells[block.elements])
    for group in sets.groups:
        members = [int(k) - 1 for row in parsed["*ELSET", group.name] for k in row]
        assert members == group.elements.tolist()


def test_med_has_its_own_order_of_hexes_and_all_groups(mesh, tmp_path):
    write_mesh(tmp_path / "mesh.med", mesh)
    back = meshio.read(tmp_path / "mesh.med")
    assert np.array_equal(back.points, mesh.points)
    kind, side = ("quad", "line") if mesh.dim == 2 else ("hexahedron", "quad")
    cells = back.get_cells_type(kind)
    order = [0, 1, 2, 3] if mesh.dim == 2 else [0, 3, 2, 1, 4, 7, 6, 5]
    assert np.array_equal(cells, mesh.cells[:, order])
    found = {}
    for which, corners in ((kind, cells), (side, back.get_cells_type(side))):
        tags = back.get_cell_data("cell_tags", which)
        for tag in np.unique(tags[tags != 0]).tolist():
            for name in back.cell_tags[tag]:
                found.setdefault(name, set()).update(facets_of(corners[tags == tag]))
    sets = find_sets(mesh)
    expected = expected_sets(mesh, once=False)
    blocks = [*sets.blocks, *sets.groups]
    assert found == expected | {b.name: facets_of(mesh.cells[b.elements]) for b in blocks}
    tags, points = back.point_data["point_tags"], {}
    for tag, names in back.point_tags.items():
        for name in names:
            points.setdefault(name, set()).update(np.flatnonzero(tags == tag).tolist())
    assert points == {name: set().union(*facets) for name, facets in expected.items()}


def read_unv(path):
    """Return the nodes, elements and groups of a universal file."""
    data = {}
    for part in path.read_text().split("    -1\n"):
        number, _, rest = part.strip("\n").partition("\n")
        if number.strip():
            data[int(number)] = rest.splitlines()
    points = np.array([line.replace("D", "E").split() for line in data[2411][1::2]], dtype=float)
    elements, lines = {}, iter(data[2412])
    for line in lines:
        label, kind, *_, n_nodes = map(int, line.split())
        if kind in (11, 24):
            next(lines)
        nodes = []
        while len(nodes) < n_nodes:
            nodes += [int(node) - 1 for node in next(lines).split()]
        elements[label] = (kind, nodes)
    groups, lines = {}, iter(data[2467])
    for line in lines:
        n, name, members = int(line.split()[-1]), next(lines), []
        while len(members) < n:
            entries = list(map(int, next(lines).split()))
            members += [tuple(entries[k : k + 2]) for k in range(0, len(entries), 4)]
        groups[name] = members
    return points, elements, groups


def test_universal_files_have_all_groups(mesh, tmp_path):
    write_mesh(tmp_path / "mesh.unv", mesh)
    points, elements, groups = read_unv(tmp_path / "mesh.unv")
    assert np.allclose(points, padded(mesh.points), rtol=1e-15, atol=1e-300)
    solid = {2: 44, 3: 115}[mesh.dim]
    cells = [nodes for kind, nodes in elements.values() if kind == solid]
    assert np.array_equal(cells, mesh.cells)
    expected = expected_sets(mesh, once=False)
    for name, facets in expected.items():
        assert {frozenset(elements[k][1]) for code, k in groups[name] if code == 8} == facets
        nodes = {k - 1 for code, k in groups[f"{name}_nodes"] if code == 7}
        assert nodes == set().union(*facets)
    sets = find_sets(mesh)
    for block in [*sets.blocks, *sets.groups]:
        assert [k - 1 for _, k in groups[block.name]] == block.elements.tolist()
    assert len(elements) == mesh.n_cells + len(mesh.boundary.corners)


def test_nastran_has_sets_of_nodes_and_pressures(mesh, tmp_path):
    write_mesh(tmp_path / "mesh.bdf", mesh)
    text = (tmp_path / "mesh.bdf").read_text()
    (tmp_path / "whole.bdf").write_text(f"BEGIN BULK\n{text}ENDDATA\n")
    back = meshio.read(tmp_path / "whole.bdf")
    assert np.allclose(back.points, padded(mesh.points), rtol=1e-9, atol=1e-9)
    cells = np.concatenate([block.data for block in back.cells])
    order = np.concatenate([block.elements for block in find_sets(mesh).blocks])
    assert np.array_equal(cells, mesh.cells[order])
    fields = [[line[k : k + 8].strip() for k in range(0, 72, 8)] for line in text.splitlines()]
    nodes, loads, number = {}, {}, None
    for line in fields:
        if line[0] == "SET1":
            number = int(line[1])
            nodes[number] = [int(k) for k in line[2:] if k]
        elif line[0] == "+" and number is not None:
            nodes[number] += [int(k) for k in line[1:] if k]
        elif line[0] == "PLOAD4":
            loads.setdefault(int(line[1]), []).append([int(line[k]) - 1 for k in (2, 7, 8)])
    for found in find_sets(mesh).facets:
        assert np.array_equal(np.array(nodes[found.number]) - 1, np.unique(found.corners))
        if mesh.dim == 3:
            element, first, third = np.array(loads[found.number]).T
            assert np.array_equal(element, found.element)
            # Corners 1 and 3 of the face are opposite each other, which names the face.
            pairs = {frozenset(pair) for pair in zip(first.tolist(), third.tolist(), strict=True)}
            assert pairs == facets_of(found.corners[:, [0, 2]])


def test_the_boundary_beside_vtu_names_its_sets(mesh, tmp_path):
    written = write_beside(tmp_path / "mesh.vtu", mesh)
    assert [path.name for path in written] == ["mesh_sets.csv", "mesh_boundary.vtu"]
    boundary = pyvista.read(tmp_path / "mesh_boundary.vtu")
    corners = boundary.cells.reshape(boundary.n_cells, -1)[:, 1:]
    number = {tuple(point): k for k, point in enumerate(padded(mesh.points).tolist())}
    of_point = np.array([number[tuple(point)] for point in boundary.points.tolist()])
    numbers = {
        key.removeprefix("set "): int(boundary.field_data[key][0]) for key in boundary.field_data
    }
    tags = boundary.cell_data["set"]
    once = expected_sets(mesh, once=True)
    assert {n: facets_of(of_point[corners[tags == k]]) for n, k in numbers.items()} == once
    for name, facets in expected_sets(mesh, once=False).items():
        if name not in once:
            inside = np.asarray(boundary.cell_data[name]) == 1
            assert facets_of(of_point[corners[inside]]) == facets
    table = pd.read_csv(tmp_path / "mesh_sets.csv")
    areas = dict(zip(table["name"], table["area"], strict=True))
    boundary["size"] = boundary.compute_cell_sizes()["Length" if mesh.dim == 2 else "Area"]
    for name, k in numbers.items():
        assert areas[name] == pytest.approx(boundary["size"][tags == k].sum(), rel=2e-3)


def test_abaqus_files_hold_numbers_that_calculix_reads(tmp_path):
    cube = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    points = 7e-5 * (cube / 3 - 1 / 7)
    points[0, 0] = -3.5527136788005009e-22
    corners = np.array([[0, 4, 6, 2, 1, 5, 7, 3]])
    write_mesh(tmp_path / "mesh.inp", VolumeMesh.from_arrays(points, corners))
    text = (tmp_path / "mesh.inp").read_text()
    nodes = text.partition("*NODE\n")[2].partition("*ELEMENT")[0].splitlines()
    fields = [row.split(", ") for row in nodes]
    assert max(len(field) for row in fields for field in row) <= 20
    assert fields[0][1] == "0"
    found = np.array(fields, dtype=float)[:, 1:]
    assert np.allclose(found, points, rtol=1e-12, atol=1e-20)


def test_what_cannot_be_written_is_said(mesh, tmp_path):
    with pytest.raises(MeshError, match="names no format"):
        write_mesh(tmp_path / "mesh.xyz", mesh)
    nothing = VolumeMesh.from_arrays(mesh.points, mesh.cells[:0])
    with pytest.raises(MeshError, match="no elements"):
        write_mesh(tmp_path / "mesh.msh", nothing)
    assert list(tmp_path.iterdir()) == []
