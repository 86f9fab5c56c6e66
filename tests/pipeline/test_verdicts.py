"""Every mesh whose volume is far from an independent one gets a warning; the others get none."""

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

#: The most facets (larger files take too long), the random points, the fewest of them inside.
MOST_FACETS, POINTS, FEWEST = 100_000, 100_000, 3_000


def independent_volume(path, geometry, is_kept):
    """Return the volume by other libraries, and the part of it where the kept cells differ.

    The volume is None if no library can compute it.
    """
    if isinstance(geometry, Image):
        volume = float(geometry.fractions((slice(None),) * 3).sum()) * geometry.voxel_size**3
        return volume, 0.0
    low, high = map(np.array, geometry.bounding_box())
    middle = (low + high) / 2
    points = np.random.default_rng(0).uniform(low, high, (POINTS, len(low)))
    if isinstance(geometry, Outline):
        points = points[: max(FEWEST, int(4e8 / len(geometry.segments)))]
        winding = igl.winding_number(geometry.points - middle, geometry.segments, points - middle)
    else:
        mesh = trimesh.Trimesh(geometry.points, geometry.triangles)
        if not mesh.is_winding_consistent:
            return None
        winding = igl.fast_winding_number(
            geometry.points - middle, geometry.triangles, points - middle
        )
    is_inside = np.abs(winding) >= 0.5
    if is_inside.sum() < FEWEST:
        return None
    differs = float((is_inside != is_kept(points)).sum() / is_inside.sum())
    if path.suffix == ".shp":
        shapes = [shape(s.__geo_interface__) for s in shapefile.Reader(str(path)).shapes()]
        return float(shapely.union_all(shapely.make_valid(shapes)).area), differs
    if not isinstance(geometry, Outline) and mesh.is_volume and mesh.body_count == 1:
        return abs(float(mesh.volume)), differs
    return float(is_inside.mean() * np.prod(high - low)), differs


def mesh_of(path):
    """Return volume ratio, difference and warnings; None where there are none."""
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
    grid, kept = fractions.grid, np.pad(built.resolved.cells.kept, 1)

    def is_kept(points):
        cell = np.floor((points - grid.origin) / grid.cell_size).astype(int) + 1
        return kept[tuple(cell.clip(0, np.array(kept.shape) - 1).T)]

    found = independent_volume(path, geometry, is_kept)
    if found is None:
        return None
    volume, differs = found
    warned = [c.id for c in built.comparison if not c.holds]
    return built.mesh.measurement.volume / volume, differs, warned


@pytest.fixture(scope="module")
def rows():
    """Return every file with its ratio and its warnings."""
    found = {f"{p.parent.name}/{p.name}": mesh_of(p) for p in [*cases(), *sample()]}
    return {name: row for name, row in found.items() if row is not None}


def test_a_mesh_that_is_off_by_a_tenth_is_warned_of(rows):
    silent = {n: row for n, row in rows.items() if abs(row[0] - 1) > 0.1 and not row[2]}
    assert silent == {}


def test_few_right_meshes_are_warned_of(rows):
    right = {n: row for n, row in rows.items() if abs(row[0] - 1) <= 0.05 and row[1] <= 0.25}
    alarms = {n: row for n, row in right.items() if row[2]}
    print(len(rows), len(right), alarms)
    assert len(right) >= 60
    assert len(alarms) < 0.05 * len(right), alarms
