"""Every format is read back by another library and compared."""

import meshio
import mfem.ser as mfem
import netCDF4
import numpy as np
import pytest
from fields import noise_mesh

from tusqh.errors import MeshError
from tusqh.meshes.boundary import SIDES
from tusqh.meshes.facets import HEX_FACETS
from tusqh.meshes.formats import write_mesh
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


def test_mfem_reads_its_own_format(mesh, tmp_path):
    write_mesh(tmp_path / "mesh.mesh", mesh)
    native = mfem.Mesh(str(tmp_path / "mesh.mesh"), 1, 0, False)
    assert (native.GetNV(), native.GetNE()) == (len(mesh.points), mesh.n_cells)
    assert native.CheckElementOrientation(False) == 0
    boundary = mesh.boundary
    assert native.GetNBE() == len(boundary.corners)
    attributes = [native.GetBdrAttribute(k) for k in range(native.GetNBE())]
    assert sorted(attributes) == sorted(boundary.attribute.tolist())
    vertices = np.array(native.GetVertexArray()).reshape(native.GetNV(), -1)[:, : mesh.dim]
    assert np.array_equal(vertices, mesh.points)


def test_meshio_reads_gmsh(mesh, tmp_path):
    write_mesh(tmp_path / "mesh.msh", mesh)
    back = meshio.read(tmp_path / "mesh.msh")
    assert np.array_equal(back.points, padded(mesh.points))
    kind = "quad" if mesh.dim == 2 else "hexahedron"
    cells = np.concatenate([block.data for block in back.cells if block.type == kind])
    solid = cells if mesh.dim == 3 else cells[-mesh.n_cells :]
    assert np.array_equal(solid, mesh.cells)
    present = {SIDES[k - 1] for k in mesh.boundary.attribute}
    assert set(back.field_data) == {*present, "solid"}
    assert (tmp_path / "mesh.msh").read_text("ascii").startswith("$MeshFormat\n2.2 0 8\n")


def test_exodus_has_side_sets(mesh, tmp_path):
    write_mesh(tmp_path / "mesh.exo", mesh)
    back = meshio.read(tmp_path / "mesh.exo")
    assert np.allclose(back.points, padded(mesh.points), rtol=0, atol=0)
    assert np.array_equal(back.cells[0].data, mesh.cells)
    boundary = mesh.boundary
    faces = [(1, 2, 6, 5), (2, 3, 7, 6), (3, 4, 8, 7), (4, 1, 5, 8), (1, 4, 3, 2), (5, 6, 7, 8)]
    sides = [(1, 2), (2, 3), (3, 4), (4, 1)] if mesh.dim == 2 else faces
    with netCDF4.Dataset(tmp_path / "mesh.exo") as file:
        assert file["eb_prop1"][:].tolist() == [1]
        assert str(netCDF4.chartostring(file["eb_names"][0])).strip("\0") == "solid"
        found = {}
        for k, attribute in enumerate(file["ss_prop1"][:], start=1):
            for element, side in zip(file[f"elem_ss{k}"][:], file[f"side_ss{k}"][:], strict=True):
                corners = mesh.cells[element - 1][np.array(sides[side - 1]) - 1]
                found[tuple(sorted(corners.tolist()))] = int(attribute)
        names = [str(netCDF4.chartostring(row)).strip("\0") for row in file["ss_names"][:]]
        assert names == [SIDES[k - 1] for k in file["ss_prop1"][:]]
    keys = map(tuple, np.sort(boundary.corners, axis=1).tolist())
    assert found == dict(zip(keys, boundary.attribute.tolist(), strict=True))


def test_meshio_reads_abaqus(mesh, tmp_path):
    write_mesh(tmp_path / "mesh.inp", mesh)
    back = meshio.read(tmp_path / "mesh.inp")
    assert np.allclose(back.points, padded(mesh.points), rtol=1e-12, atol=1e-12)
    assert np.array_equal(back.cells[0].data, mesh.cells)
    faces = [(1, 2, 3, 4), (5, 8, 7, 6), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 8, 4), (4, 8, 5, 1)]
    sides = [(1, 2), (2, 3), (3, 4), (4, 1)] if mesh.dim == 2 else faces
    name, found = "", {}
    for line in (tmp_path / "mesh.inp").read_text().splitlines():
        if line.startswith("*"):
            name = line.partition("NAME=")[2]
        elif name:
            element, side = line.split(", S")
            corners = mesh.cells[int(element) - 1][np.array(sides[int(side) - 1]) - 1]
            found[tuple(sorted(corners.tolist()))] = SIDES.index(name) + 1
    boundary = mesh.boundary
    keys = map(tuple, np.sort(boundary.corners, axis=1).tolist())
    assert found == dict(zip(keys, boundary.attribute.tolist(), strict=True))


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
