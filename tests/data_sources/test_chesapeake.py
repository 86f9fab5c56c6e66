import csv
import hashlib
import json
import re
from pathlib import Path

import numpy as np
import pytest
import shapely

from tusqh.geometry.defects import describe_defects
from tusqh.readers.files import read_file

REPOSITORY = Path(__file__).resolve().parents[2]
FOLDER = REPOSITORY / "data_sources" / "chesapeake"
WINDOW = shapely.box(250_000, 4_075_000, 490_000, 4_391_000)

#: The rows of `describe_defects` by their names in the register.
WORDS = {
    "gaps": "border_gaps",
    "overlaps": "border_overlaps",
    "crossings": "crossings",
    "duplicate": "duplicate_segments",
    "zero-length": "zero_length_segments",
}

with (FOLDER.parent / "register.csv").open(newline="", encoding="utf-8") as file:
    ROWS = {row["model"]: row for row in csv.DictReader(file) if "chesapeake/" in row["file"]}


def land_of(name: str):
    """Return the part of the window that a file covers."""
    features = json.loads((FOLDER / name).read_text(encoding="ascii"))["features"]
    shapes = [shapely.from_geojson(json.dumps(feature["geometry"])) for feature in features]
    return shapely.union_all(shapely.make_valid(shapes)).intersection(WINDOW)


def test_every_file_is_registered():
    assert {row["file"] for row in ROWS.values()} == {
        path.relative_to(REPOSITORY).as_posix() for path in FOLDER.glob("*.geojson")
    }


@pytest.mark.parametrize("model", ROWS)
def test_sha256_matches(model):
    content = (REPOSITORY / ROWS[model]["file"]).read_bytes()
    assert hashlib.sha256(content).hexdigest() == ROWS[model]["sha256"]


@pytest.mark.parametrize("model", ["chesapeake", "chesapeake_clean", "chesapeake_overlay"])
def test_defects_are_those_of_the_register(model):
    row = ROWS[model]
    outline = read_file(REPOSITORY / row["file"]).geometry
    table = describe_defects(outline).set_index("defect")["count"]
    found = re.findall(rf"(\d+) ({'|'.join(WORDS)})\b", row["known_defects"])
    stated = {WORDS[word]: int(count) for count, word in found}
    assert bool(stated) == (model != "chesapeake_clean")
    for defect, count in stated.items():
        # Slivers at the limit of rounding may differ between versions of GEOS.
        slack = 0.02 if defect.startswith("border") else 0.0
        assert table[defect] == pytest.approx(count, rel=slack), defect
    if model == "chesapeake_clean":
        assert not table[[*WORDS.values(), "open_ends", "touching"]].any()


@pytest.mark.parametrize("name", ["counties.geojson", "overlay.geojson"])
def test_no_land_is_missing_and_water_is_open(name):
    land, states = land_of(name), land_of("states.geojson")
    assert land.symmetric_difference(states).area < 0.01 * WINDOW.area
    assert 0.7 * WINDOW.area < land.area < 0.8 * WINDOW.area
    mid_bay, mouth = shapely.points([[385_000, 4_220_000], [425_000, 4_093_000]])
    assert not shapely.contains(land, [mid_bay, mouth]).any()


@pytest.mark.parametrize("name", ["counties.geojson", "states.geojson", "overlay.geojson"])
def test_rings_repeat_their_first_point_and_outer_ones_run_clockwise(name):
    for feature in json.loads((FOLDER / name).read_text(encoding="ascii"))["features"]:
        for polygon in feature["geometry"]["coordinates"]:
            for number, ring in enumerate(polygon):
                points = np.array(ring) - ring[0]
                assert ring[0] == ring[-1]
                area = (points[:-1, 0] * points[1:, 1] - points[1:, 0] * points[:-1, 1]).sum()
                assert (area < 0) == (number == 0), feature["properties"]["name"]
