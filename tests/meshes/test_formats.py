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


def test_facets_face_the_side_of_their_attribute(mesh):
    boundary = mesh.boundary
    centre = mesh.points[mesh.cells].mean(axis=1)[boundary.element]
    away = mesh.points[boundary.corners].mean(axis=1) - centre
    for axis in range(mesh.dim):
        for side, sign in enumerate((-1, 1)):
            facing = boundary.attribute == 2 * axis + side + 1
            assert facing.any()
            assert (sign * away[facing, axis] > 0).all()
            flat = mesh.points[boundary.corners[facing]][..., axis]
            assert np.allclose(flat, flat[:, :1])
    assert (boundary.attribute == len(SIDES)).any()
    if mesh.dim == 3:
        corners = mesh.cells[boundary.element][:, HEX_FACETS]
        assert np.array_equal(corners[np.arange(len(corners)), boundary.local], boundary.corners)


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
    assert set(back.field_data) >= {*SIDES, "solid"}


def test_exodus_has_side_sets(mesh, tmp_path):
    write_mesh(tmp_path / "mesh.exo", mesh)
    back = meshio.read(tmp_path / "mesh.exo")
    assert np.allclose(back.points, padded(mesh.points), rtol=0, atol=0)
    assert np.array_equal(back.cells[0].data, mesh.cells)
    boundary = mesh.boundary
    faces = [(1, 2, 6, 5), (2, 3, 7, 6), (3, 4, 8, 7), (4, 1, 5, 8), (1, 4, 3, 2), (5, 6, 7, 8)]
    sides = [(1, 2), (2, 3), (3, 4), (4, 1)] if mesh.dim == 2 else faces
    with netCDF4.Dataset(tmp_path / "mesh.exo") as file:
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
    assert np.array_equal(back.points, padded(mesh.points))
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


def test_what_cannot_be_written_is_said(mesh, tmp_path):
    with pytest.raises(MeshError, match="names no format"):
        write_mesh(tmp_path / "mesh.xyz", mesh)
    nothing = VolumeMesh.from_arrays(mesh.points, mesh.cells[:0])
    with pytest.raises(MeshError, match="no elements"):
        write_mesh(tmp_path / "mesh.msh", nothing)
    assert list(tmp_path.iterdir()) == []
