"""Parts that point inwards are turned, cavities are kept, and both cause a remark."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from tusqh.geometry.soup import Soup
from tusqh.geometry.soup_facts import SoupFacts
from tusqh.pipeline.sample import sample
from tusqh.readers.files import read_file
from tusqh.sampling.orient import orient
from tusqh.settings.grid import Grid

CASES = Path(__file__).parents[1] / "cases"


def soup_of(*meshes):
    return Soup.from_parts([(np.asarray(m.vertices), np.asarray(m.faces)) for m in meshes])


def as_stl(soup):
    """Return the same triangles without connectivity, in one part."""
    points = soup.points[soup.triangles].reshape(-1, 3)
    numbers = np.arange(len(points)).reshape(-1, 3)
    return Soup(points, numbers, np.zeros(len(numbers), dtype=np.int64))


def flipped(soup, chosen):
    triangles = soup.triangles.copy()
    triangles[chosen] = triangles[chosen][:, ::-1]
    return Soup(soup.points, triangles, soup.parts)


def volume(soup):
    return SoupFacts(soup).signed_volume


def box(size, centre=(0, 0, 0)):
    return trimesh.creation.box(extents=[size] * 3).apply_translation(centre)


def text(reading):
    return "\n".join(map(str, reading.remarks))


@pytest.mark.parametrize("seed", range(20))
def test_assemblies_with_parts_inside_out_keep_every_part(seed):
    rng = np.random.default_rng(seed)
    makers = [
        lambda: trimesh.creation.icosphere(2, 1.0),
        lambda: trimesh.creation.box(extents=rng.uniform(0.2, 2, 3)),
        lambda: trimesh.creation.torus(0.7, 0.2, 16, 8),
        lambda: trimesh.creation.annulus(0.3, 0.8, 1.0),
    ]
    n = int(rng.integers(2, 12))
    meshes = [makers[rng.integers(4)]().apply_translation([3 * k, 0, 0]) for k in range(n)]
    expected = sum(m.volume for m in meshes)
    turned = rng.random(n) < 0.5
    for m in np.flatnonzero(turned):
        meshes[m].invert()
    reading = orient(as_stl(soup_of(*meshes)), "auto")
    assert volume(reading.geometry) == pytest.approx(expected, rel=1e-9)
    if turned.any():
        assert f"changed: {turned.sum()} parts turned" in text(reading)
        first = np.flatnonzero(turned)[0]
        assert f"part {first + 1} of" in text(reading)
    else:
        assert not reading.remarks


@pytest.mark.parametrize("seed", range(20))
def test_every_part_of_an_assembly_inside_out_is_in_the_samples(seed):
    rng = np.random.default_rng(100 + seed)
    makers = [
        lambda: trimesh.creation.icosphere(2, 1.0),
        lambda: trimesh.creation.box(extents=rng.uniform(0.8, 2, 3)),
        lambda: trimesh.creation.torus(0.7, 0.3, 16, 8),
        lambda: trimesh.creation.annulus(0.3, 0.8, 1.0),
    ]
    n = int(rng.integers(2, 6))
    turns = [trimesh.transformations.random_rotation_matrix(rng.random(3)) for _ in range(n)]
    meshes = [makers[rng.integers(4)]().apply_transform(turn) for turn in turns]
    for k, mesh in enumerate(meshes):
        mesh.apply_translation([4 * k, 0, 0])
    volumes = np.array([m.volume for m in meshes])
    turned = np.flatnonzero(np.append(True, rng.random(n - 1) < 0.5))
    for m in turned:
        meshes[m].invert()
    geometry = as_stl(soup_of(*meshes))
    fractions = sample(geometry, grid=Grid(cell_size=0.15, placement="corner"))
    assert fractions.volume() == pytest.approx(volumes.sum(), rel=0.01)
    centres = fractions.grid.origin[0] + 0.15 * (np.arange(fractions.grid.shape[0]) + 0.5)
    part = np.rint(centres / 4).astype(np.int64)
    found = np.bincount(part, fractions.cells.sum(axis=(1, 2)) * 0.15**3, minlength=n)
    assert found == pytest.approx(volumes, rel=0.05)
    said = text(orient(geometry, "auto"))
    assert f"changed: {len(turned)} parts turned" in said
    for m in turned[:3]:
        assert f"part {m + 1} of" in said


@pytest.mark.parametrize("seed", range(20))
def test_solids_with_a_third_of_the_triangles_flipped_are_whole_again(seed):
    rng = np.random.default_rng(seed)
    mesh = [
        trimesh.creation.icosphere(3, 1.0),
        trimesh.creation.torus(1.0, 0.3, 24, 12),
        trimesh.creation.cylinder(0.5, 2.0, sections=24),
        trimesh.creation.annulus(0.5, 1.0, 1.0, sections=24),
    ][seed % 4]
    soup = as_stl(soup_of(mesh))
    chosen = rng.permutation(len(soup.triangles))[: len(soup.triangles) // 3]
    reading = orient(flipped(soup, chosen), "auto")
    assert volume(reading.geometry) == pytest.approx(mesh.volume, rel=1e-9)
    assert "triangles turned that point the other way" in text(reading)


def test_nothing_changes_where_every_part_points_outwards():
    soup = as_stl(soup_of(box(1), box(1, (3, 0, 0))))
    reading = orient(soup, "auto")
    assert reading.geometry is soup
    assert not reading.remarks


def test_cavities_stay_cavities_whichever_way_the_file_points():
    hollow = [box(4), box(2)]
    hollow[1].invert()
    soup = soup_of(*hollow)
    for is_inside_out in (False, True):
        every = slice(None) if is_inside_out else slice(0, 0)
        reading = orient(flipped(soup, every), "auto")
        assert volume(reading.geometry) == pytest.approx(64 - 8)
        assert ("turned" in text(reading)) == is_inside_out


def test_a_solid_in_a_cavity_is_material():
    shells = [box(4), box(2), box(1)]
    shells[1].invert()
    shells[2].invert()
    assert volume(orient(soup_of(*shells), "auto").geometry) == pytest.approx(64 - 8 + 1)


def test_parts_that_touch_in_a_face_are_apart_where_the_file_names_them():
    second = box(1, (1, 0, 0))
    second.invert()
    assert volume(orient(soup_of(box(1), second), "auto").geometry) == pytest.approx(2)


def test_overlapping_parts_that_point_inwards_are_turned():
    second = box(1, (0.5, 0.5, 0.5))
    second.invert()
    assert volume(orient(soup_of(box(1), second), "auto").geometry) == pytest.approx(2)


@pytest.mark.parametrize("orientation", ["as-is", "flip"])
def test_other_settings_count_and_leave_everything(orientation):
    second = box(1, (3, 0, 0))
    second.invert()
    soup = soup_of(box(2), second)
    reading = orient(soup, orientation)
    assert reading.geometry is soup
    assert "noted: 1 parts found that point inwards" in text(reading)


def test_an_open_cylinder_inside_out_is_turned_with_its_loose_caps():
    mesh = trimesh.creation.cylinder(0.5, 2.0, sections=24)
    is_cap = np.abs(mesh.face_normals[:, 2]) > 0.5
    side, caps = (mesh.submesh([np.flatnonzero(c)])[0] for c in (~is_cap, is_cap))
    caps.apply_scale(0.999)
    loose = soup_of(side, caps)
    reading = orient(flipped(loose, slice(None)), "auto")
    assert np.array_equal(reading.geometry.triangles, loose.triangles)


def test_a_one_sided_surface_is_counted_and_left():
    n = 12
    angle = np.linspace(0, 2 * np.pi, n, endpoint=False)
    edge = np.stack([np.cos(angle / 2) * np.cos(angle), np.cos(angle / 2) * np.sin(angle)], 1)
    rim = 0.3 * np.column_stack([edge, np.sin(angle / 2)])
    ring = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    points = np.concatenate([ring - rim, ring + rim])
    faces = []
    for k in range(n):
        a, b, c, d = k, k + 1, k + n, k + n + 1
        if k == n - 1:
            b, d = n, 0
        faces += [[a, b, c], [b, d, c]]
    soup = Soup(points, np.array(faces), np.zeros(2 * n, dtype=np.int64))
    reading = orient(soup, "auto")
    assert reading.geometry is soup
    assert "have only one side" in text(reading)


@pytest.mark.parametrize(
    ("name", "expected", "said"),
    [
        ("03_part_inside_out/u15_small_inverted.stl", 108, "changed: 1 parts turned"),
        ("04_mirrored_halves_crash/u16_mirror_equal.stl", 4, "changed: 1 parts turned"),
        ("31_open_or_inconsistent/u04_random_flips.stl", 33.22, "triangles turned"),
    ],
)
def test_cases_have_their_volume(name, expected, said):
    reading = orient(read_file(CASES / name).geometry, "auto")
    assert volume(reading.geometry) == pytest.approx(expected, rel=1e-3)
    assert said in text(reading)


def test_a_terrain_has_no_inside():
    reading = orient(read_file(CASES / "31_open_or_inconsistent/u14_terrain.stl").geometry, "auto")
    assert "noted: 1 open sheets without an inside" in text(reading)


def test_triangles_without_area_alone_are_no_part():
    flat = Soup(np.eye(3), np.array([[0, 1, 1]]), np.array([0]))
    assert orient(flat, "auto") == (flat, ())
