"""No mesh far from an independent volume is suitable without a warning; right ones get none."""

import igl
import numpy as np
import pytest
import shapefile
import shapely
import trimesh
from corpus import cases, sample
from shapely.geometry import shape

from tusqh.errors import TusqhError
from tusqh.extras import MissingExtraError
from tusqh.geometry.image import Image
from tusqh.geometry.outline import Outline
from tusqh.pipeline.build import build
from tusqh.pipeline.ingest import ingest
from tusqh.pipeline.original import Original
from tusqh.pipeline.select import select
from tusqh.settings.grid import Grid
from tusqh.settings.sampling import Sampling

pytestmark = pytest.mark.slow

#: Larger files take too long; random points, and the fewest of them inside that say enough.
MOST_FACETS, POINTS, FEWEST = 200_000, 100_000, 5_000


def independent_volume(path, geometry):
    """Return the volume by another library; None where none can tell."""
    if isinstance(geometry, Image):
        return float(geometry.fractions((slice(None),) * 3).sum()) * geometry.voxel_size**3
    if path.suffix == ".shp":
        shapes = [shape(s.__geo_interface__) for s in shapefile.Reader(str(path)).shapes()]
        return float(shapely.union_all(shapely.make_valid(shapes)).area)
    low, high = map(np.array, geometry.bounding_box())
    middle = (low + high) / 2
    points = np.random.default_rng(0).uniform(low, high, (POINTS, len(low))) - middle
    if isinstance(geometry, Outline):
        points = points[: max(FEWEST, int(4e8 / len(geometry.segments)))]
        winding = igl.winding_number(geometry.points - middle, geometry.segments, points)
    else:
        mesh = trimesh.Trimesh(geometry.points, geometry.triangles)
        if not mesh.is_winding_consistent:
            return None
        if mesh.is_volume and mesh.body_count == 1:
            return abs(float(mesh.volume))
        winding = igl.fast_winding_number(geometry.points - middle, geometry.triangles, points)
    is_inside = np.abs(winding) >= 0.5
    if is_inside.sum() < FEWEST:
        return None
    return float(is_inside.mean() * np.prod(high - low))


def mesh_of(path):
    """Return the ratio to the independent volume and the warnings, None where there are none."""
    try:
        geometry = ingest(path)
        facets = getattr(geometry, "triangles", getattr(geometry, "segments", ()))
        if len(facets) > MOST_FACETS:
            return None
        cells = 48 if isinstance(geometry, Outline) else 24
        original = Original(geometry, Grid(cells=cells), Sampling())
        fractions = original.sample()
        built = build(fractions, select(fractions).selection, original=original)
    except (TusqhError, MissingExtraError):
        return None
    volume = independent_volume(path, geometry)
    if volume is None:
        return None
    return built.mesh.measurement.volume / volume, [c.id for c in built.comparison if not c.holds]


@pytest.fixture(scope="module")
def rows():
    """Every file with its ratio and its warnings."""
    found = {f"{p.parent.name}/{p.name}": mesh_of(p) for p in [*cases(), *sample()]}
    return {name: row for name, row in found.items() if row is not None}


def test_a_mesh_that_is_off_by_a_tenth_is_warned_of(rows):
    silent = {
        n: ratio for n, (ratio, warned) in rows.items() if abs(ratio - 1) > 0.1 and not warned
    }
    assert silent == {}


def test_few_right_meshes_are_warned_of(rows):
    right = {n: warned for n, (ratio, warned) in rows.items() if abs(ratio - 1) <= 0.05}
    alarms = {n: warned for n, warned in right.items() if warned}
    assert len(right) >= 60
    assert len(alarms) < 0.05 * len(right), alarms
