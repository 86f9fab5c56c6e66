"""Files of several materials have the volume of every material when other libraries read them."""

import meshio
import mfem.ser as mfem
import netCDF4
import numpy as np
import pytest

from tusqh.contacts import MaterialFractions, fractions_of_labels, mesh_materials
from tusqh.errors import SamplingError, TopologyError
from tusqh.grid import BackgroundGrid
from tusqh.meshes.jacobians import element_volumes

FULL = 2**20


@pytest.fixture(params=[2, 3], ids=["quads", "hexes"])
def found(request):
    rng = np.random.default_rng(3)
    image = rng.integers(0, 4, (4, 5, 3)[: request.param])
    return mesh_materials(fractions_of_labels(image, void=0, names={1: "bone", 3: "outer shell"}))


def volumes_of(found):
    return {name: measured.volume for name, measured in found.measured.items()}


def volume(points, cells):
    return element_volumes(np.asarray(points)[:, : 2 if cells.shape[1] == 4 else 3], cells).sum()


def test_vtu_and_gmsh(found, tmp_path):
    expected = list(volumes_of(found).values())
    found.write(tmp_path / "a.vtu")
    read = meshio.read(tmp_path / "a.vtu")
    (material,) = read.cell_data["material"]
    cells = read.cells[0].data
    by_vtu = [volume(read.points, cells[material == k]) for k in (1, 2, 3)]
    assert np.allclose(by_vtu, expected)
    found.write(tmp_path / "a.msh")
    read = meshio.read(tmp_path / "a.msh")
    dim = found.mesh.dim
    numbers = {n: k for n, (k, d) in read.field_data.items() if d == dim}
    assert list(numbers) == ["bone", "2", "outer_shell"]
    kind = "quad" if dim == 2 else "hexahedron"
    groups = read.get_cell_data("gmsh:physical", kind)
    cells = read.get_cells_type(kind)
    assert np.allclose(
        [volume(read.points, cells[groups == k]) for k in numbers.values()], expected
    )


def test_mfem_and_exodus(found, tmp_path):
    expected = list(volumes_of(found).values())
    found.write(tmp_path / "a.mesh")
    read = mfem.Mesh(str(tmp_path / "a.mesh"))
    attributes = np.array([read.GetAttribute(i) for i in range(read.GetNE())])
    assert attributes.tolist() == (found.material + 1).tolist()
    found.write(tmp_path / "a.exo")
    with netCDF4.Dataset(tmp_path / "a.exo") as file:
        assert file["eb_prop1"][:].tolist() == [1, 2, 3]
        names = [bytes(row.compressed()).rstrip(b"\0") for row in file["eb_names"][:]]
        assert names == [b"bone", b"2", b"outer_shell"]
        points = np.asarray(file["coord"][:]).T
        blocks = [np.asarray(file[f"connect{k}"][:]) - 1 for k in (1, 2, 3)]
        assert np.allclose([volume(points, block) for block in blocks], expected)
        # The sides of the boundary belong to the elements as they are numbered here.
        cells = np.concatenate(blocks)
        boundary = {frozenset(row) for row in found.mesh.boundary.corners.tolist()}
        for k in range(1, len(file.dimensions["num_side_sets"]) + 1):
            for element in np.asarray(file[f"elem_ss{k}"][:]) - 1:
                assert any(corners <= set(cells[element].tolist()) for corners in boundary)


def test_abaqus(found, tmp_path):
    found.write(tmp_path / "a.inp")
    read = meshio.read(tmp_path / "a.inp")
    sizes = [len(block.data) for block in read.cells]
    assert sizes == np.bincount(found.material).tolist()


def test_wrong_input_is_named():
    image = np.array([[1, 2], [2, 1]])
    with pytest.raises(SamplingError, match="no voxel with the labels"):
        fractions_of_labels(image, names={3: "bone"})
    with pytest.raises(SamplingError, match="several labels called"):
        fractions_of_labels(image, names={1: "2"})
    with pytest.raises(SamplingError, match="interpolate no labels"):
        fractions_of_labels(image + 0.5)
    with pytest.raises(SamplingError, match="at least one label"):
        fractions_of_labels(np.zeros((2, 2), dtype=int), void=0)
    with pytest.raises(TopologyError, match="threshold"):
        mesh_materials(image, thresholds={"3": 0.5})
    with pytest.raises(TopologyError, match="threshold"):
        mesh_materials(image, thresholds={"1": 0.0})
    grid = BackgroundGrid(shape=(1, 1), cell_size=1.0, origin=(0.0, 0.0))
    with pytest.raises(TopologyError, match="more than 1"):
        MaterialFractions.from_multiples(grid, ["a", "b"], 2 * [np.full((3, 3), FULL * 3 // 4)])


def test_fractions_of_labels_are_shares_of_voxels():
    """Compare cells of 1, 2 and 3 voxels with the mean of finer voxels over each cube."""
    rng = np.random.default_rng(0)
    image = rng.integers(0, 3, (6, 6, 6))
    for c in (1, 2, 3):
        found = fractions_of_labels(image, voxels_per_cell=c, void=0)
        fine = np.pad(image.repeat(2, 0).repeat(2, 1).repeat(2, 2), c)
        places = np.argwhere(np.ones(tuple(2 * n + 1 for n in found.grid.shape), dtype=bool))
        places = places[(places % 2).sum(axis=1) != 2][::7]
        n = 2 * 6 // c + 1
        flat = (places[:, 0] * n + places[:, 1]) * n + places[:, 2]
        several = np.tile(np.arange(3, dtype=np.int32), (len(flat), 1))
        multiples = found.multiples_at(flat, several)
        for (i, j, k), shares in zip(places, multiples / FULL, strict=True):
            cube = fine[i * c : i * c + 2 * c, j * c : j * c + 2 * c, k * c : k * c + 2 * c]
            expected = [(cube == label).mean() for label in (1, 2, 0)]
            assert np.allclose(shares, expected, atol=2**-19)
