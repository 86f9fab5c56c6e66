"""Sample files in installed packages: right by an independent reader, or refused with a reason."""

from importlib import metadata
from pathlib import Path

import meshio
import numpy as np
import pytest
import shapefile
import trimesh
from PIL import Image as Picture

from tusqh.errors import GeometryError
from tusqh.extras import MissingExtraError
from tusqh.readers.files import read_file
from tusqh.readers.formats import suffixes_of

PACKAGES = (
    *("matplotlib", "mfem", "mkdocs-material", "numpy", "plotly-geo", "pymeshlab", "pyvista"),
    *("scikit-image", "scipy", "sphinx", "trimesh"),
)
#: Of each package and suffix at most this many files, evenly over their names.
MOST = 20


def sample():
    """Return files of every supported format in the packages that are installed."""
    files = []
    for package in PACKAGES:
        try:
            listed = metadata.files(package) or []
        except metadata.PackageNotFoundError:
            continue
        for suffix in set(suffixes_of()) - {".json", ".csv"}:
            found = sorted(f for f in listed if f.suffix.lower() == suffix)
            step = -(-len(found) // MOST) or 1
            files += [Path(str(f.locate())) for f in found[::step]]
    return sorted(files)


def independent_box(path):
    """Return the bounding box by another reader, None where there is none to ask."""
    suffix = path.suffix.lower()
    if suffix == ".npy":
        return np.zeros(3), np.array(np.load(path, mmap_mode="r").shape)
    if suffix in (".tif", ".tiff"):
        with Picture.open(path) as picture:
            return np.zeros(3), np.array([*picture.size, picture.n_frames])
    if suffix == ".shp":
        box = np.array(shapefile.Reader(str(path)).bbox)
        return box[:2], box[2:]
    if suffix in (".obj", ".ply", ".stl", ".off"):
        mesh = trimesh.load(path, process=False, force="mesh")
        points = mesh.vertices[np.unique(mesh.faces)]
        return points.min(axis=0), points.max(axis=0)
    if suffix == ".vtk":
        try:
            mesh = meshio.read(path)
        except (meshio.ReadError, KeyError, SystemExit):
            return None
        points = mesh.points[np.unique(np.concatenate([c.data.ravel() for c in mesh.cells]))]
        return points.min(axis=0), points.max(axis=0)
    return None


@pytest.mark.parametrize("path", sample(), ids=lambda path: "/".join(path.parts[-2:]))
def test_a_sample_file_is_right_or_refused_with_a_reason(path, capfd):
    try:
        reading = read_file(path)
    except MissingExtraError:
        pytest.skip("the library of this format is not installed")
    except GeometryError as error:
        parts = error.found, error.where, error.expected, error.remedy
        assert all(parts)
        assert not any("\n" in part for part in parts)
        assert "Traceback" not in capfd.readouterr().err
        return
    assert not capfd.readouterr().err
    low, high = map(np.asarray, reading.geometry.bounding_box())
    expected = independent_box(path)
    if expected is not None:
        size = np.ptp(expected, axis=0).max()
        assert low == pytest.approx(expected[0][: len(low)], abs=1e-6 * size)
        assert high == pytest.approx(expected[1][: len(high)], abs=1e-6 * size)


def test_the_corpus_has_files_of_many_formats():
    assert len({path.suffix.lower() for path in sample()}) >= 6
