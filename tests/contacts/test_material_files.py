"""Files of several materials have the volume of every material when other libraries read them."""

import automesh
import meshio
import mfem.ser as mfem
import netCDF4
import numpy as np
import pytest

from tusqh.contacts import MaterialFractions, fractions_of_labels, mesh_materials
from tusqh.errors import SamplingError, TopologyError
from tusqh.grid import BackgroundGrid
from tusqh.meshes.export import read_regions
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
    regions = read_regions(tmp_path / "a.vtu")
    assert regions.names == found.names
    assert np.array_equal(regions.material, found.material)
    by_vtu = [volume(read.points, cells[material == k]) for k in (1, 2, 3)]
    assert np.allclose(by_vtu, expected)
    found.write(tmp_path / "a.msh")
    read = meshio.read(tmp_path / "a.msh")
    dim = found.mesh.dim
    numbers = {n: k for n, (k, d) in read.field_data.items() if d == dim}
    assert list(numbers) == ["bone", "2", "outer_shell"]
    kinds = {n: k for n, (k, d) in read.field_data.items() if d == dim - 1}
    sides = read.get_cell_data("gmsh:physical", "line" if dim == 2 else "quad")
    for a, b, name in (("bone", "2", "bone|2"), ("2", "outer shell", "2|outer_shell")):
        assert (sides == kinds[name]).sum() == len(found.interfaces[a, b].facets)
    assert "2|bone" not in kinds
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
    text = (tmp_path / "a.mesh").read_text()
    number = int(text.split(" bone|2: facets of bone that face 2")[0].rpartition("# ")[2])
    sides = [read.GetBdrAttribute(i) for i in range(read.GetNBE())]
    assert sides.count(number) == len(found.interfaces["bone", "2"].facets)
    found.write(tmp_path / "a.exo")
    with netCDF4.Dataset(tmp_path / "a.exo") as file:
        assert file["eb_prop1"][:].tolist() == [1, 2, 3]
        names = [bytes(row.compressed()).rstrip(b"\0") for row in file["eb_names"][:]]
        assert names == [b"bone", b"2", b"outer_shell"]
        points = np.asarray(file["coord"][:]).T
        blocks = [np.asarray(file[f"connect{k}"][:]) - 1 for k in (1, 2, 3)]
        assert np.allclose([volume(points, block) for block in blocks], expected)
        check_sets(file, found, np.concatenate(blocks), points)


def check_sets(file, found, cells, points):
    """Compare side sets with the boundary and the interfaces, and node sets with the points."""
    names = [bytes(row.compressed()).rstrip(b"\0").decode() for row in file["ss_names"][:]]
    pairs = [name for name in names if "|" in name]
    plain = dict(zip(found.names, ("bone", "2", "outer_shell", "void"), strict=True))
    by_name = {f"{plain[a]}|{plain[b]}": i for (a, b), i in found.interfaces.items()}
    assert sorted(pairs) == sorted(by_name)
    boundary = {frozenset(row) for row in found.mesh.boundary.corners.tolist()}
    for k, name in enumerate(names, start=1):
        elements, sides = (np.asarray(file[f"{kind}_ss{k}"][:]) - 1 for kind in ("elem", "side"))
        corners = [frozenset(row) for row in exodus_sides(cells[elements], sides).tolist()]
        expected = boundary
        if name in by_name:
            expected = {frozenset(row) for row in by_name[name].facets.tolist()}
            assert set(corners) == expected
        assert set(corners) <= expected
    names = [bytes(row.compressed()).rstrip(b"\0").decode() for row in file["ns_names"][:]]
    assert "bone|2|void" in names
    for k, name in enumerate(names, start=1):
        if name.count("|") != 2:
            continue
        own = set((np.asarray(file[f"node_ns{k}"][:]) - 1).tolist())
        three = [next(n for n, p in plain.items() if p == x) for x in name.split("|")]
        touching = [
            set(np.unique(found.mesh.boundary.corners).tolist())
            if x == "void"
            else set(found.mesh.cells[found.material == found.names.index(x)].ravel().tolist())
            for x in three
        ]
        assert own == set.intersection(*touching)


def exodus_sides(cells, sides):
    """Return the corners of sides as the Exodus manual numbers them."""
    quad = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    hexes = [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [0, 4, 7, 3], [0, 3, 2, 1], [4, 5, 6, 7]]
    table = quad if cells.shape[1] == 4 else np.array(hexes)
    return np.take_along_axis(cells, table[sides], axis=1)


def test_abaqus(found, tmp_path):
    found.write(tmp_path / "a.inp")
    read = meshio.read(tmp_path / "a.inp")
    text = (tmp_path / "a.inp").read_text()
    assert "*SURFACE, TYPE=ELEMENT, NAME=2_to_bone\n" in text
    assert "*NSET, NSET=bone_and_2_and_void\n" in text
    sizes = [len(block.data) for block in read.cells]
    assert sizes == np.bincount(found.material).tolist()


def test_labels_of_sculpt_are_read_as_automesh_reads_them(tmp_path):
    """The page on several materials says how to read a file of Sculpt."""
    labels = np.random.default_rng(4).integers(0, 3, (2, 3, 4)).astype(np.uint8)
    np.savetxt(tmp_path / "a.spn", labels.transpose().ravel(), fmt="%d")
    automesh.Voxels.from_spn(str(tmp_path / "a.spn"), [2, 3, 4]).write_npy(str(tmp_path / "a.npy"))
    assert np.array_equal(np.load(tmp_path / "a.npy"), labels)
    read = np.loadtxt(tmp_path / "a.spn", dtype=int).reshape(4, 3, 2).transpose()
    assert np.array_equal(read, labels)


def test_a_part_alone_has_the_elements_of_its_block(found, tmp_path):
    found.write(tmp_path / "all.exo")
    blocks = meshio.read(tmp_path / "all.exo")
    for k, name in enumerate(["bone", "2", "outer shell"]):
        part = found.part(name)
        block = blocks.points[blocks.cells[k].data][..., : found.mesh.dim]
        assert np.array_equal(part.points[part.cells], block)


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
