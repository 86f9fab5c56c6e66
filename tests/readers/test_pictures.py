"""Pictures are models in the plane, whose material is their grey values."""

import numpy as np
import pytest
import shapely
from PIL import Image as Pillow
from typer.testing import CliRunner

import tusqh
from tusqh.cli.app import app
from tusqh.errors import GeometryError, SamplingError
from tusqh.figures.style import lines_of
from tusqh.geometry.canonical import load_geometry, write_geometry
from tusqh.geometry.defects import describe_defects
from tusqh.geometry.image import Image
from tusqh.readers.files import read_file
from tusqh.sampling.voxels import lay_on_voxels, voxel_fractions

#: A letter F, which no turn and no reflection leaves unchanged, indexed [row, column].
LETTER = np.zeros((9, 7), dtype=np.uint8)
LETTER[1:8, 1:3] = LETTER[1:3, 1:6] = LETTER[4:6, 1:5] = 255


def save(path, pixels, **options):
    """Write a picture, and return its path."""
    Pillow.fromarray(pixels).save(path, **options)
    return path


def remarks_of(reading):
    return [str(remark) for remark in reading.remarks]


def test_a_picture_lies_as_it_is_shown(tmp_path):
    image = read_file(save(tmp_path / "a.png", LETTER)).geometry
    assert image.bounding_box() == ((0, 0), (7, 9))
    full = {(x, y) for x, y in np.argwhere(image.fractions() > 0.5).tolist()}
    rows, columns = np.nonzero(LETTER)
    assert full == {(x, 8 - row) for row, x in zip(rows.tolist(), columns.tolist(), strict=True)}


@pytest.mark.parametrize("seed", range(4))
def test_fractions_are_areas(seed):
    """Shapely intersects the pixels with every half of a cell."""
    rng = np.random.default_rng(seed)
    image = Image(rng.random(rng.integers(3, 9, 2)) < 0.5, 0.5, origin=(1.0, -2.0))
    grid = lay_on_voxels(image, cells=int(rng.integers(2, 5)))
    found = voxel_fractions(image, grid)
    corners = np.argwhere(image.voxels) * 0.5 + image.origin
    region = shapely.union_all(shapely.box(*corners.T, *(corners + 0.5).T))
    half = grid.cell_size / 2
    for place in np.ndindex(found.values.shape):
        if sum(k % 2 for k in place) == 1:
            continue  # A value on an edge follows from those of its ends and cells.
        middle = np.add(grid.origin, np.multiply(place, half))
        around = shapely.box(*(middle - half), *(middle + half))
        expected = region.intersection(around).area / around.area
        assert found.values[place] == pytest.approx(expected, abs=1e-6)


def test_a_mesh_of_a_picture_has_its_topology_and_its_size(tmp_path):
    path = save(tmp_path / "a.png", LETTER)
    found = tusqh.mesh(path, cell_size=0.1, image={"voxel_size": 0.1}, unit="mm", betti=(1, 0))
    assert found.mesh.dim == 2
    assert found.mesh.unit == "mm"
    assert found.mesh.measurement.volume == pytest.approx((LETTER > 0).sum() * 0.01)
    of_array = tusqh.mesh(LETTER[::-1].T, cell_size=1.0, betti=(1, 0))
    assert np.array_equal(of_array.mesh.cells, found.mesh.cells)


def test_a_fitted_disc_is_round(tmp_path):
    y, x = np.mgrid[0:120, 0:120] - 59.5
    path = save(tmp_path / "disc.png", np.uint8(255 * np.clip(40.5 - np.hypot(x, y), 0, 1)))
    mesh = tusqh.mesh(path, cells=30, betti=(1, 0), fit=True).mesh
    assert mesh.measurement.volume == pytest.approx(np.pi * 40**2, rel=2e-3)
    edges = mesh.cells[:, [[0, 1], [1, 2], [2, 3], [3, 0]]].reshape(-1, 2)
    _, index, count = np.unique(np.sort(edges), axis=0, return_index=True, return_counts=True)
    border = np.unique(edges[index[count == 1]])
    radii = np.linalg.norm(mesh.points[border] - 60, axis=1)
    assert radii == pytest.approx(np.full(len(radii), 40.0), abs=0.4)


def test_materials_of_a_picture_are_those_of_its_array(tmp_path):
    labels = np.zeros((12, 10), dtype=np.uint8)
    labels[2:6, 2:8], labels[6:11, 2:8] = 1, 2
    path = save(tmp_path / "a.png", labels[::-1].T.copy().T)
    named = {1: "bone", 2: "marrow"}
    found = tusqh.mesh(path, cells=12, materials=named).mesh
    expected = tusqh.mesh(labels[::-1].T[:, ::-1], cells=12, materials=named).mesh
    assert found.dim == expected.dim == 2
    assert np.array_equal(found.cells, expected.cells)
    alone = tusqh.mesh(path, cells=12, image={"labels": [2]}).mesh
    assert alone.n_cells == (labels == 2).sum()


def test_what_jpeg_loses_is_noted(tmp_path):
    large = np.kron(LETTER, np.ones((7, 7), dtype=np.uint8))
    reading = read_file(save(tmp_path / "a.jpg", large, quality=60))
    assert any("lossy compression" in text for text in remarks_of(reading))
    exact = read_file(save(tmp_path / "a.png", large)).geometry
    assert np.abs(reading.geometry.fractions() - exact.fractions()).mean() < 0.05
    assert len(np.unique(reading.geometry.voxels)) > 2


def test_colours_are_refused_or_chosen_from(tmp_path):
    colours = np.stack([LETTER, LETTER // 2, 0 * LETTER], axis=-1)
    path = save(tmp_path / "a.png", colours)
    with pytest.raises(GeometryError, match="3 colours"):
        read_file(path)
    found = read_file(path, image={"channel": 1}).geometry
    assert found.voxels.max() == 127
    for k, pixels in enumerate((np.stack([LETTER] * 3, axis=-1), _with_alpha(255))):
        grey = read_file(save(tmp_path / f"grey{k}.png", pixels)).geometry
        assert np.array_equal(grey.voxels, LETTER[::-1].T)
    with pytest.raises(GeometryError, match="4 colours, the transparency included"):
        read_file(save(tmp_path / "b.png", _with_alpha(LETTER)))


def _with_alpha(alpha):
    return np.stack([LETTER] * 3 + [np.zeros_like(LETTER) + alpha], axis=-1)


def test_sixteen_bits_and_turned_pictures(tmp_path):
    deep = read_file(save(tmp_path / "a.png", LETTER.astype(np.uint16) * 200)).geometry
    assert deep.voxels.max() == 51000
    tags = Pillow.Exif()
    tags[0x0112] = 6  # The picture is shown after a quarter turn clockwise.
    reading = read_file(save(tmp_path / "b.png", np.rot90(LETTER).copy(), exif=tags))
    assert np.array_equal(reading.geometry.voxels, LETTER[::-1].T)
    assert any("Orientation 6" in text for text in remarks_of(reading))


def test_dark_material_and_resolutions_are_noted(tmp_path):
    reading = read_file(save(tmp_path / "a.png", 255 - LETTER, dpi=(300, 300)))
    said = " ".join(remarks_of(reading))
    assert "give `empty: 255` and `full: 0`" in said
    assert "resolution for printing" in said
    reading = read_file(tmp_path / "a.png", image={"empty": 255, "full": 0})
    assert reading.geometry.fractions().sum() == (LETTER > 0).sum()
    assert "bright" not in " ".join(remarks_of(reading))


def test_films_and_single_slices_of_volumes_are_refused(tmp_path):
    frames = [Pillow.fromarray(LETTER), Pillow.fromarray(255 - LETTER)]
    frames[0].save(tmp_path / "a.png", save_all=True, append_images=frames[1:])
    with pytest.raises(GeometryError, match="2 pictures"):
        read_file(tmp_path / "a.png")
    np.save(tmp_path / "a.npy", LETTER)
    with pytest.raises(GeometryError, match="a single slice") as caught:
        read_file(tmp_path / "a.npy")
    assert "PNG" in caught.value.remedy


def test_numbers_for_three_axes_are_refused(tmp_path):
    path = save(tmp_path / "a.png", LETTER)
    with pytest.raises(SamplingError, match=r"`grid\.cells` has 3 numbers, the image has 2"):
        tusqh.mesh(path, cells=(4, 4, 4))
    with pytest.raises(SamplingError, match="`window` has 3 numbers, the image has 2"):
        tusqh.mesh(path, cells=4, window=[(0, 0, 0), (1, 1, 1)])


def test_a_picture_is_kept_in_every_bit(tmp_path):
    image = Image(LETTER, 0.25, 1, 99, (1.0, 2.0), "a.png", "mm")
    write_geometry(tmp_path / "a.vtp", image)
    found = load_geometry(tmp_path / "a.vtp")
    assert np.array_equal(found.voxels, LETTER)
    assert (found.origin, found.voxel_size, found.unit) == ((1.0, 2.0), 0.25, "mm")
    table = describe_defects(found).set_index("defect")
    assert table.loc["voxels", "unit"] == "mm^2"
    assert table.loc["voxels", "measure"] == LETTER.size / 16


def test_lines_between_full_and_empty_pixels_are_the_boundary():
    image = Image(LETTER[::-1].T, 0.5, full=255, origin=(3.0, 1.0))
    corners = np.argwhere(image.voxels) * 0.5 + image.origin
    region = shapely.union_all(shapely.box(*corners.T, *(corners + 0.5).T))
    drawn = shapely.union_all(shapely.linestrings(lines_of(image)))
    assert drawn.length == pytest.approx(region.length)
    assert drawn.symmetric_difference(region.boundary).length == pytest.approx(0, abs=1e-9)


def test_the_commands_take_pictures(tmp_path):
    path, mesh = str(save(tmp_path / "a.png", LETTER)), str(tmp_path / "a.vtu")
    runner = CliRunner()
    done = runner.invoke(app, ["mesh", path, "--cells", "9", "--betti", "1,0", "-o", mesh])
    assert done.exit_code == 0, done.output
    assert "PNG: 7 x 9 pixels" in done.output
    done = runner.invoke(app, ["inspect", path, "--cells", "9"])
    assert done.exit_code == 0, done.output
    assert "pixels at least half full" in done.output
    done = runner.invoke(app, ["mesh", path, "--cells", "9", "--voids-min-cells", "2", "-o", mesh])
    assert done.exit_code != 0 or "without effect" in done.output
