"""Volumes and interfaces of materials agree: with the box, with each other, and in files."""

import meshio
import netCDF4
import numpy as np
import pytest
from random_materials import random_materials
from test_material_files import exodus_sides

import tusqh
from tusqh.contacts import mesh_materials
from tusqh.meshes.formats import write_mesh
from tusqh.meshes.interfaces import find_junction_edges, find_junctions


def random_meshes(dim, seeds, **options):
    """Return meshes of random fields with contacts everywhere."""
    for seed in seeds:
        fractions, thresholds = random_materials(seed, dim, 4)
        yield fractions.grid, mesh_materials(fractions, thresholds=thresholds, **options)


def measure(points, sides):
    """Return the vector area of sides, which may be bent, shape (n, dim)."""
    if sides.shape[1] == 2:
        along = points[sides[:, 1]] - points[sides[:, 0]]
        return np.stack([along[:, 1], -along[:, 0]], axis=1)
    a, b, c, d = points[sides].transpose(1, 0, 2)
    return np.cross(c - a, d - b) / 2


def enclosed(points, sides):
    """Return the volume inside sides by the divergence theorem: 1/dim of the flux of x."""
    if sides.shape[1] == 2:
        (ax, ay), (bx, by) = points[sides].transpose(1, 2, 0)
        return (ax * by - ay * bx).sum() / 2
    # The flux through a bilinear side is the mean of those through its two pairs of triangles.
    total = 0.0
    for three in ((0, 1, 2), (0, 2, 3), (0, 1, 3), (1, 2, 3)):
        corners = points[sides[:, three]]
        total += np.linalg.det(corners).sum() / 6
    return total / 2


@pytest.mark.parametrize("dim", [2, 3])
def test_the_volumes_of_all_materials_and_the_void_fill_the_box(dim):
    """The void is meshed in the grid and in one layer of cells around it."""
    for grid, found in random_meshes(dim, range(10), with_void=True):
        box = np.prod([n + 2 for n in grid.shape]) * grid.cell_size**dim
        volumes = [measured.volume for measured in found.measured.values()]
        assert sum(volumes) == pytest.approx(box, rel=1e-12)


@pytest.mark.parametrize("dim", [2, 3])
def test_interfaces_of_a_material_enclose_its_volume(dim):
    """Compare with the sum over its elements; a facet too many or too few changes it."""
    n = 0
    for _, found in random_meshes(dim, range(20, 28)):
        for name, measured in found.measured.items():
            own = [i.facets for (first, _), i in found.interfaces.items() if first == name]
            volume = enclosed(found.mesh.points, np.concatenate(own))
            assert volume == pytest.approx(measured.volume, rel=1e-9), name
            n += 1
    assert n > 10


@pytest.mark.parametrize("dim", [2, 3])
def test_side_sets_of_a_pair_have_equal_areas_and_opposite_normals(dim, tmp_path):
    """Read both from an Exodus file, in which each is elements and sides of its own material."""
    n_pairs = 0
    for k, (_, found) in enumerate(random_meshes(dim, range(30, 36))):
        path = tmp_path / f"{k}.exo"
        found.write(path)
        with netCDF4.Dataset(path) as file:
            points = np.asarray(file["coord"][:]).T[:, :dim]
            blocks = [np.asarray(file[name][:]) - 1 for name in sorted(
                (v for v in file.variables if v.startswith("connect")), key=lambda v: int(v[7:])
            )]  # fmt: skip
            cells = np.concatenate(blocks)
            sides = {}
            for s, row in enumerate(file["ss_names"][:], start=1):
                name = bytes(row.compressed()).rstrip(b"\0").decode()
                elements = np.asarray(file[f"elem_ss{s}"][:]) - 1
                local = np.asarray(file[f"side_ss{s}"][:]) - 1
                sides[name] = exodus_sides(cells[elements], local)
        for name, first in sides.items():
            a, _, b = name.partition("|")
            if f"{b}|{a}" not in sides:
                continue
            second = sides[f"{b}|{a}"]
            n_pairs += 1
            areas = [np.linalg.norm(measure(points, s), axis=1).sum() for s in (first, second)]
            assert areas[0] == pytest.approx(areas[1], rel=1e-12), name
            by_corners = [
                {frozenset(row): v for row, v in zip(s.tolist(), measure(points, s), strict=True)}
                for s in (first, second)
            ]
            assert by_corners[0].keys() == by_corners[1].keys(), name
            for corners, vector in by_corners[0].items():
                assert vector == pytest.approx(-by_corners[1][corners], abs=1e-12), name
    assert n_pairs > 10


def test_a_part_of_the_bearing_alone_is_its_block(repository, tmp_path):
    """Compare coordinates bit for bit after writing both and reading them by another library."""
    found = tusqh.mesh(repository / "data_sources/solids/bearings.stl", cells=16, materials="parts")
    found.write(tmp_path / "all.exo")
    whole = meshio.read(tmp_path / "all.exo")
    names = [name for name in found.names if name in found.built.measured]
    assert len(whole.cells) == len(names) >= 8
    for block, name in zip(whole.cells, names, strict=True):
        part = found.part(name)
        assert part.measurement.is_sound
        assert part.measurement.by_euler == found.built.measured[name].by_euler
        write_mesh(tmp_path / "part.exo", part)
        alone = meshio.read(tmp_path / "part.exo")
        (cells,) = alone.cells
        assert np.array_equal(alone.points[cells.data], whole.points[block.data]), name


def test_many_points_and_materials_do_not_overflow():
    """Of 65,535 names three occur; points and edges are those of three names alone."""
    image = np.ones((34, 34, 34), dtype=np.uint8)
    image[:, 17:], image[17:, :17] = 2, 3
    found = mesh_materials(image)
    points = len(found.mesh.points)
    assert points * 65_535 > 2**31
    few = find_junctions(found.mesh, found.material, ("1", "2", "3", "void"))
    names = ("1", "2", "3", *(f"absent {k}" for k in range(65_531)), "void")
    many = find_junctions(found.mesh, found.material, names)
    assert many.keys() == few.keys()
    assert len(few) == 4
    for key, at in few.items():
        assert np.array_equal(many[key], at), key
    edges = find_junction_edges(found.mesh, found.material)
    lengths = np.linalg.norm(np.diff(found.mesh.points[edges], axis=1)[:, 0], axis=1)
    # A T on the top and the bottom, the line between them, and the ends of three walls.
    assert lengths == pytest.approx(np.ones(len(edges)))
    assert len(edges) == 2 * (34 + 17) + 34 + 3 * 34
