"""Voxels that are boxes, or turned, become cubes with exactly the same material."""

import nrrd
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import tusqh
from tusqh.errors import GeometryError
from tusqh.readers.boxes_to_cubes import resample_boxes, resample_turned
from tusqh.readers.files import read_file


def write(path, voxels, directions, origin=(0.0, 0.0, 0.0)):
    header = {"space dimension": 3, "space directions": directions, "space origin": origin}
    nrrd.write(str(path), voxels, {**header, "space units": ["mm"] * 3}, index_order="F")
    return path


@pytest.mark.parametrize("seed", range(12))
def test_turned_voxels_keep_their_volume_and_centre(seed):
    rng = np.random.default_rng(seed)
    values = rng.random(rng.integers(1, 5, size=3)) * (rng.random() < 0.8 or 1.0)
    steps = Rotation.random(random_state=seed).as_matrix() * rng.uniform(0.5, 2, size=(3, 1))
    if seed % 3 == 0:  # A gantry that is tilted: the axes are not at right angles.
        steps[2] += 0.3 * steps[1]
    corner, size = rng.normal(size=3), float(rng.uniform(0.3, 1.5))
    cubes, origin = resample_turned(values, steps, corner, size)
    volume = cubes.sum() * size**3
    assert volume == pytest.approx(values.sum() * abs(np.linalg.det(steps)))
    middles = corner + (np.indices(values.shape).reshape(3, -1).T + 0.5) @ steps
    centre = (middles * values.reshape(-1, 1)).sum(axis=0) / values.sum()
    # The means over cubes have their first moments in the cubes' middles up to the cube size.
    of_cubes = origin + size * (np.indices(cubes.shape).reshape(3, -1).T + 0.5)
    found = (of_cubes * cubes.reshape(-1, 1)).sum(axis=0) / cubes.sum()
    assert found == pytest.approx(centre, abs=size / 2)


def test_turned_voxels_agree_with_counted_points():
    rng = np.random.default_rng(7)
    values = rng.random((3, 4, 2))
    steps = Rotation.from_rotvec([0.4, -0.3, 0.8]).as_matrix() * [[1.0], [0.6], [1.4]]
    cubes, origin = resample_turned(values, steps, np.array([1.0, 2.0, 3.0]), 0.8)
    points = origin + 0.8 * rng.random((400_000, 3)) * cubes.shape
    voxel = np.floor((points - [1.0, 2.0, 3.0]) @ np.linalg.inv(steps)).astype(int)
    is_in = ((voxel >= 0) & (voxel < values.shape)).all(axis=1)
    at = np.where(is_in, values[tuple(np.where(is_in[:, None], voxel, 0).T)], 0.0)
    cube = np.floor((points - origin) / 0.8).astype(int)
    sums, counts = np.zeros(cubes.shape), np.zeros(cubes.shape)
    np.add.at(sums, tuple(cube.T), at)
    np.add.at(counts, tuple(cube.T), 1)
    assert np.abs(sums / counts - cubes).max() < 6 * 0.5 / np.sqrt(counts.min())


@pytest.mark.parametrize("seed", range(6))
def test_both_methods_agree_on_boxes_along_the_axes(seed):
    rng = np.random.default_rng(seed)
    values, sides = rng.random(rng.integers(1, 6, size=3)), rng.uniform(0.4, 2, size=3)
    size = float(sides.min())
    plain = resample_boxes(values, sides, size)
    turned, origin = resample_turned(values, np.diag(sides), np.zeros(3), size)
    assert plain == pytest.approx(turned, abs=1e-12)
    assert np.array_equal(origin, np.zeros(3))


def test_slices_of_a_scan_become_cubes(tmp_path):
    voxels = np.zeros((6, 6, 4), dtype=np.uint8)
    voxels[1:5, 1:5, 1:3] = 255
    path = write(tmp_path / "a.nrrd", voxels, np.diag([0.5, 0.5, 1.25]), (0.25, 0.25, 0.625))
    reading = read_file(path)
    image = reading.geometry
    assert (image.voxel_size, image.origin, image.shape) == (0.5, (0.0, 0.0, 0.0), (6, 6, 10))
    assert image.fractions()[2, 2].tolist() == [0, 0, 0.5, 1, 1, 1, 1, 0.5, 0, 0]
    assert str(reading.remarks[-1]).startswith("changed: 144 voxels of 0.5 x 0.5 x 1.25 resampled")
    result = tusqh.mesh(path, cells=12, threshold=0.5)
    assert result.mesh.unit == "mm"
    assert result.mesh.measurement.volume == pytest.approx(2 * 2 * 3.0)


def test_a_turned_block_has_its_volume_and_place(tmp_path):
    steps = Rotation.from_rotvec([0, 0, np.pi / 6]).as_matrix().T * 0.5
    path = write(tmp_path / "a.nrrd", np.ones((12, 8, 6), dtype=np.uint8), steps, (1.0, 2.0, 3.0))
    image = read_file(path).geometry
    assert image.fractions().sum() * image.voxel_size**3 == pytest.approx(12 * 8 * 6 * 0.125)
    result = tusqh.mesh(path, cells=40, threshold=0.5)
    assert result.mesh.measurement.volume == pytest.approx(72, rel=0.03)


def test_labels_of_materials_are_not_averaged(tmp_path):
    voxels = np.ones((4, 4, 4), dtype=np.uint8)
    voxels[2:] = 2
    path = write(tmp_path / "a.nrrd", voxels, np.diag([1.0, 1.0, 2.0]))
    with pytest.raises(
        GeometryError, match=r"a voxel measures 1 x 1 x 2, .* and voxels are labels"
    ):
        tusqh.mesh(path, materials="labels")
