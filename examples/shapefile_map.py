"""The islands of a shapefile: ``python examples/shapefile_map.py [FOLDER]``.

Hawaii has eight main islands.  On cells of 9 km a threshold of 1/2 loses one of them; asked for
eight components, Tusqh finds the thresholds that keep all of them, and adds only the cells that it
takes.

The outlines are those of the US Census Bureau inside the Python package plotly-geo; distances need
metres, so they are projected first (UTM zone 4N, pyproj): ``pip install ".[data]"``.
"""

import sys
from pathlib import Path

import numpy as np
import pyproj
import shapefile

import tusqh
from tusqh.geometry.packaged import locate

STATES = "package:plotly-geo/package_data/cb_2016_us_state_500k.shp"

#: The small islands in the north-west lie west of this easting, in metres.
MAIN_ISLANDS = 300_000


def write_islands(path: Path) -> None:
    """Write the main islands of Hawaii as a shapefile in metres."""
    project = pyproj.Transformer.from_crs("EPSG:4269", "EPSG:26904", always_xy=True)
    with shapefile.Reader(str(locate(STATES)), encoding="latin-1") as reader:
        (shape,) = (s.shape for s in reader.iterShapeRecords() if s.record["STUSPS"] == "HI")
    rings = np.split(np.array(shape.points), list(shape.parts)[1:])
    rings = [np.column_stack(project.transform(*ring.T)) for ring in rings]
    path.parent.mkdir(parents=True, exist_ok=True)
    with shapefile.Writer(str(path), shapeType=shapefile.POLYGON) as writer:
        writer.field("name", "C")
        for ring in rings:
            if ring[:, 0].min() > MAIN_ISLANDS:
                writer.poly([ring.tolist()])
                writer.record("Hawaii")


def main(folder: Path) -> tuple[tusqh.Result, tusqh.Result]:
    """Mesh the islands twice, at a threshold of 1/2 and so that there are eight."""
    islands = folder / "hawaii.shp"
    write_islands(islands)
    options = {"cells": 64, "components": {"min_cells": 2}}
    plain = tusqh.mesh(islands, threshold=0.5, **options)
    print(f"threshold 1/2: {plain.report.measured.betti_0} islands\n")
    eight = tusqh.mesh(islands, betti=(8, 0), **options)
    print(eight.report)
    eight.save(folder)
    return plain, eight


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "hawaii"))
