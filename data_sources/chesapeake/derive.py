"""Derive the three outlines of the Chesapeake Bay from the Census Bureau's boundary files.

The source is the package plotly-geo 1.0.0, which carries the cartographic boundary files
1:500 000 of the US Census Bureau (public domain).  Beside this script it writes, in metres of
UTM zone 18N (EPSG:26918, from longitude and latitude in NAD83, EPSG:4269) rounded to 0.1 m:

``counties.geojson`` (model ``chesapeake``)
    The 2016 counties.  Every ring is simplified separately, in degrees and before projection, so
    two counties no longer agree on their common border, which has gaps and overlaps.
``states.geojson`` (model ``chesapeake_clean``)
    The 2016 states, not simplified, clipped by a box 40 km larger than the window, because the
    whole rings would reach the Ohio.  The clip box appears as straight borders outside the window.
``overlay.geojson`` (model ``chesapeake_overlay``)
    The 2010 counties, not simplified, laid over those states, with doubled and offset borders.

Every feature is one county or state.  Outer rings run clockwise, as in the source, and repeat
their first point at the end.  Run it from anywhere: ``python data_sources/chesapeake/derive.py``.
"""

from __future__ import annotations

import importlib.util
import json
import logging
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import shapefile
import shapely
from numpy.typing import NDArray
from pyproj import Transformer
from shapely.geometry import LineString, MultiPolygon, Polygon, box
from shapely.geometry.polygon import orient

HERE = Path(__file__).resolve().parent
LOG = logging.getLogger("chesapeake")

#: The window of the models: west, south, east, north in metres (UTM 18N).
WINDOW = (250_000.0, 4_075_000.0, 490_000.0, 4_391_000.0)
#: Distance beyond the window up to which a polygon is kept, so that land covers the whole window.
KEEP_MARGIN = 12_000.0
#: Distance beyond the window at which the states are clipped.
CLIP_MARGIN = 40_000.0
#: Tolerance of the simplification in degrees, about 300 m.  It is well above the source's vertex
#: spacing, so that borders separate, and well below the width of a river worth meshing.
SIMPLIFY = 0.003
#: Number of decimals of coordinates in metres in the files.
DECIMALS = 1

TO_UTM = Transformer.from_crs("EPSG:4269", "EPSG:26918", always_xy=True)

Ring = NDArray[np.float64]


@dataclass(frozen=True)
class Region:
    """A county or state: polygons, each a list of rings (outer first) of shape (n, 2)."""

    geoid: str
    name: str
    polygons: list[list[Ring]]
    n_collapsed: int = 0


def window_box(margin: float) -> Polygon:
    west, south, east, north = WINDOW
    return box(west - margin, south - margin, east + margin, north + margin)


def read_regions(name: str) -> Iterator[Region]:
    """Yield the regions of a shapefile inside plotly-geo, in degrees."""
    spec = importlib.util.find_spec("_plotly_geo")
    if spec is None or spec.origin is None:
        raise SystemExit("plotly-geo is not installed: run `pip install -e .[data]`")
    path = Path(spec.origin).parent / "package_data" / name
    with shapefile.Reader(str(path), encoding="latin-1") as reader:
        for item in reader.iterShapeRecords():
            record, shape = item.record.as_dict(), item.shape.__geo_interface__
            parts = shape["coordinates"]
            yield Region(
                geoid=record.get("GEOID") or record["GEO_ID"].split("US")[1],
                name=record["NAME"],
                polygons=[
                    [np.asarray(ring, dtype=np.float64) for ring in polygon]
                    for polygon in (parts if shape["type"] == "MultiPolygon" else [parts])
                ],
            )


def simplify_rings(region: Region) -> Region:
    """Return the region with every ring simplified separately; rings without area are dropped."""
    polygons, n_collapsed = [], 0
    for polygon in region.polygons:
        rings = [
            shapely.get_coordinates(LineString(ring).simplify(SIMPLIFY, preserve_topology=False))
            for ring in polygon
        ]
        kept = [ring for ring in rings if len(ring) >= 4]
        n_collapsed += len(rings) - len(kept)
        if len(rings[0]) >= 4:
            polygons.append(kept)
    return Region(region.geoid, region.name, polygons, n_collapsed)


def project(region: Region) -> Region:
    """Return the region in metres, rounded as in the files."""
    polygons = [
        [np.round(np.column_stack(TO_UTM.transform(*ring.T)), DECIMALS) for ring in polygon]
        for polygon in region.polygons
    ]
    return Region(region.geoid, region.name, polygons, region.n_collapsed)


def keep_near(region: Region, area: Polygon) -> Region:
    """Return the region without the polygons that lie entirely outside the area."""
    shapes = [shapely.make_valid(Polygon(polygon[0])) for polygon in region.polygons]
    near = shapely.intersects(shapes, area)
    polygons = [p for p, is_near in zip(region.polygons, near, strict=True) if is_near]
    return Region(region.geoid, region.name, polygons, region.n_collapsed)


def clip(region: Region, area: Polygon) -> Region:
    """Return the region clipped by the area, with rings oriented as in the source."""
    whole = MultiPolygon([(polygon[0], polygon[1:]) for polygon in region.polygons])
    cut = shapely.normalize(whole.intersection(area))
    parts = [orient(p, sign=-1.0) for p in shapely.get_parts(cut) if p.geom_type == "Polygon"]
    polygons = [
        [np.round(np.asarray(ring.coords), DECIMALS) for ring in (part.exterior, *part.interiors)]
        for part in parts
    ]
    return Region(region.geoid, region.name, polygons, region.n_collapsed)


def near_window(regions: Iterable[Region]) -> list[Region]:
    """Return the regions in metres that come near the window, sorted by GEOID."""
    area = window_box(KEEP_MARGIN)
    near = [keep_near(project(region), area) for region in regions if in_the_east(region)]
    return sorted((r for r in near if r.polygons), key=lambda r: r.geoid)


def in_the_east(region: Region) -> bool:
    """Return whether a polygon comes near zone 18N, so that not all of the country is projected."""
    return any(
        p[0][:, 0].max() > -79.5
        and p[0][:, 0].min() < -73.5
        and p[0][:, 1].max() > 35.5
        and p[0][:, 1].min() < 41
        for p in region.polygons
    )


def to_feature(region: Region, source: str) -> dict[str, Any]:
    return {
        "type": "Feature",
        "properties": {
            "GEOID": region.geoid,
            "name": region.name,
            "source": source,
            "collapsed_rings": region.n_collapsed,
        },
        "geometry": {
            "type": "MultiPolygon",
            "coordinates": [[ring.tolist() for ring in polygon] for polygon in region.polygons],
        },
    }


def write_collection(path: Path, description: str, features: list[dict[str, Any]]) -> None:
    """Write a GeoJSON file with one feature per line."""
    head = {
        "type": "FeatureCollection",
        "name": path.stem,
        "description": f"{description} Metres, UTM zone 18N (EPSG:26918). "
        "US Census Bureau cartographic boundary files 1:500 000, public domain.",
    }
    lines = ",\n".join(json.dumps(f, separators=(",", ":"), ensure_ascii=True) for f in features)
    text = json.dumps(head, separators=(",", ":"))[:-1] + ',"features":[\n' + lines + "\n]}\n"
    path.write_text(text, encoding="ascii", newline="\n")
    LOG.info("%s: %d features, %d bytes", path.name, len(features), len(text))


def main() -> None:
    """Write the three files."""
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    counties_2016 = near_window(
        simplify_rings(r) for r in read_regions("cb_2016_us_county_500k.shp")
    )
    counties_2010 = near_window(read_regions("gz_2010_us_050_00_500k.shp"))
    states_2016 = [
        clip(r, window_box(CLIP_MARGIN))
        for r in near_window(read_regions("cb_2016_us_state_500k.shp"))
    ]
    LOG.info("collapsed rings: %d", sum(r.n_collapsed for r in counties_2016))
    states = [to_feature(r, "cb_2016_us_state_500k") for r in states_2016]
    write_collection(
        HERE / "counties.geojson",
        "Counties of 2016 around the Chesapeake Bay, every ring simplified alone by 0.003 degrees.",
        [to_feature(r, "cb_2016_us_county_500k") for r in counties_2016],
    )
    write_collection(
        HERE / "states.geojson",
        "States of 2016 around the Chesapeake Bay, clipped 40 km beyond the window.",
        states,
    )
    write_collection(
        HERE / "overlay.geojson",
        "Counties of 2010 laid over the states of 2016.",
        [to_feature(r, "gz_2010_us_050_00_500k") for r in counties_2010] + states,
    )


if __name__ == "__main__":
    main()
