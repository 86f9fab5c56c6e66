"""Single features are opened, cut and filled by name, and nothing else changes."""

import itertools
import json

import numpy as np
import pandas as pd
import pytest
from flag_complexes import betti_by_flag_complex
from test_random_fields import NO_BRIDGES, random_field
from typer.testing import CliRunner

import tusqh
from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.certificate import FILE_NAME, check_certificate
from tusqh.cli.app import app
from tusqh.errors import ConfigError, TopologyError
from tusqh.grid import BackgroundGrid
from tusqh.hashing import canonical_json
from tusqh.local_topology.changeable import Impossible
from tusqh.local_topology.classes import list_classes
from tusqh.local_topology.feature_cells import FeatureCellSets
from tusqh.local_topology.features import Features
from tusqh.local_topology.name_features import find_wishes
from tusqh.local_topology.wishes import CUT, FILL, OPEN, Wish
from tusqh.meshes.export import read_vtu
from tusqh.quality.verification import VERIFICATION_COLUMNS
from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.arguments import from_options, to_words
from tusqh.settings.features import Feature
from tusqh.settings.model import Settings
from tusqh.topology.betti_numbers import BettiNumbers


def fractions_of(cells):
    """Return fractions with empty sub-cells, on a grid of cells of size 1."""
    values = np.zeros(tuple(2 * n + 1 for n in cells.shape))
    values[(slice(1, None, 2),) * cells.ndim] = cells
    grid = BackgroundGrid(shape=cells.shape, cell_size=1.0, origin=(0.0,) * cells.ndim)
    return VolumeFractions.from_values(grid, 4, values)


def plate():
    """Return a plate with 4 by 4 holes of 2 by 2 cells, which lies at the sides of the grid."""
    cells = np.ones((18, 18, 3))
    for i, j in itertools.product(range(4), repeat=2):
        cells[2 + 4 * i : 4 + 4 * i, 2 + 4 * j : 4 + 4 * j] = 0.0
    return cells


HOLES = [(3 + 4 * i, 3 + 4 * j, 1.5) for i, j in itertools.product(range(4), repeat=2)]


def change(cell_sets, named, base=0.5):
    """Return the cells after wishes."""
    features = Features(cell_sets, base)
    return FeatureCellSets(cell_sets, find_wishes(features, named)).at(base)


def holes_left(cells):
    """Return which of the holes of the plate light passes through, by the cells alone."""
    return [
        not cells.kept[int(x) - 1 : int(x) + 1, int(y) - 1 : int(y) + 1].any(axis=2).all()
        for x, y, _ in HOLES
    ]


@pytest.mark.parametrize("seed", range(3))
def test_any_subset_of_the_holes_of_a_plate_is_filled(seed):
    is_filled = np.random.default_rng(seed).random(16) < 0.5
    named = [
        Feature(do="fill", kind="hole", near=point)
        for point, fills in zip(HOLES, is_filled, strict=True)
        if fills
    ]
    cells = change(CellSets(fractions_of(plate())), named)
    assert holes_left(cells) == (~is_filled).tolist()
    measured = build_mesh(cells, cells.fractions.grid).mesh.measurement
    assert measured.has_topology((1, 16 - is_filled.sum(), 0))
    assert measured.is_sound
    table = cells.changes
    assert (table["cells"] == 4).all()  # One layer of each hole.
    assert (table[["change", "do", "class"]] == ["added", "fill", "hole"]).all(axis=None)
    assert len(table) == is_filled.sum()
    assert cells.n_changes == table["cells"].sum()


def test_holes_of_a_plate_are_cut_and_filled_together():
    cells = change(
        CellSets(fractions_of(plate())),
        [
            Feature(do="fill", kind="hole", near=HOLES[5]),
            Feature(do="cut", kind="hole", near=HOLES[0]),
            Feature(do="open", kind="hole", near=HOLES[6]),
        ],
    )
    assert tuple(cells.predicted) == (1, 14, 0)
    assert sorted(cells.changes["change"]) == ["added", "left out"]


def torus():
    """Return the fractions of a ring around the z axis, sampled at points of every cell."""
    axis = (np.arange(36) + 0.5) / 3 - 6
    x, y, z = np.meshgrid(axis, axis, axis[12:24], indexing="ij")
    inside = (np.hypot(x, y) - 4) ** 2 + z**2 < 1.7**2
    return inside.reshape(12, 3, 12, 3, 4, 3).mean(axis=(1, 3, 5))


@pytest.mark.parametrize(("do", "most"), [("fill", 24), ("cut", 14)])
def test_the_hole_of_a_torus(do, most):
    cell_sets = CellSets(fractions_of(torus()))
    assert tuple(cell_sets.at(0.5).predicted) == (1, 1, 0)
    cells = change(cell_sets, [Feature(do=do, kind="hole", near=(6, 6, 2))])
    assert tuple(cells.predicted) == (1, 0, 0)
    assert build_mesh(cells, cells.fractions.grid).mesh.measurement.has_topology((1, 0, 0))
    assert 0 < cells.n_changes <= most


def test_the_places_belong_to_the_rows_of_the_diagram():
    n_cells = 0
    for seed in range(20):
        dim = 2 + seed % 2
        fractions = random_field(seed, dim, 7 - dim)
        topology = CellSets(fractions, NO_BRIDGES).topology
        pairs, classes = topology.pairs, list_classes(fractions, topology)
        columns = ["dimension", "birth", "death", "persistence"]
        assert (classes[columns] == pairs[columns]).all(axis=None)
        values = np.clip(fractions.values, 0, 1)
        ends = classes[classes["death_place"] >= 0]
        places = np.unravel_index(ends["death_place"], values.shape)
        is_cell = (np.stack(places) % 2).all(axis=0)
        n_cells += int(is_cell.sum())
        assert np.array_equal(values[places][is_cell], ends["death"][is_cell])
        assert ((classes["death_place"] >= 0) | (classes["dimension"] == 0)).all()
    assert n_cells > 20


@pytest.mark.parametrize("dim", [2, 3])
def test_parts_that_nothing_joins_meet_where_they_are_nearest(dim):
    """The second part is three cells from the first one, and the third one is four from it."""
    cells = np.zeros((9, 15, 3)[:dim])
    cells[:, :3] = 1.0
    cells[3:6, 6:8] = 0.8
    cells[4, 12:14] = 0.6
    topology = CellSets(fractions_of(cells), NO_BRIDGES).topology
    classes = list_classes(fractions_of(cells), topology)
    places = classes.loc[classes["class"] == "component", "death_place"].to_numpy()
    index = np.stack(np.unravel_index(places[1:], topology.multiples.shape), axis=1) // 2
    assert places[0] == -1
    assert index[:, 0].tolist() == [4, 4]
    assert index[0, 1] in (3, 4, 5)
    assert index[1, 1] in (9, 10)


def check_wishes(seed, dim, largest, mesh_every=1):
    """Do everything possible to every class of a random field; return how many changed cells.

    Meshing takes most of the time, so it is done for some of the results only.
    """
    fractions, n = random_field(seed, dim, largest), 0
    features = Features(CellSets(fractions, NO_BRIDGES), 0.5)
    start, base = features.start(), features.space.start
    for row, about in enumerate(features.classes.itertuples()):
        for do in (CUT, FILL) if about.is_there else (OPEN,):
            try:
                done = features.apply(start, Wish(row, do))
            except Impossible:
                continue
            n += 1
            cells = features.space.cell_set(done.kept)
            expected = np.array(base.predicted)
            if do == OPEN:
                expected[about.dimension] += 1
            assert (row in done.there) == (do == OPEN)
            for ended in start.there - done.there:
                expected[features.classes["dimension"][ended]] -= 1
            assert tuple(cells.predicted) == tuple(expected) == tuple(done.betti)
            if seed % 4 == 0:  # It takes much longer than the other two counts.
                assert betti_by_flag_complex(cells.kept, features.space.votes) == tuple(expected)
            changed = cells.kept != base.kept
            assert (cells.kept[changed] == (do == FILL or about.birth < 0.5)).all()
            if n % mesh_every == 0:
                measured = build_mesh(cells, fractions.grid).mesh.measurement
                assert measured.has_topology(BettiNumbers(*expected.tolist()))
                assert measured.is_sound
    return n


@pytest.mark.parametrize(("dim", "n_fields"), [(2, 8), (3, 6)])
def test_one_feature_changes_in_random_fields(dim, n_fields):
    assert sum(check_wishes(seed, dim, 7 - dim) for seed in range(n_fields)) > 20


@pytest.mark.slow
@pytest.mark.parametrize(("dim", "n_fields"), [(2, 2500), (3, 500)])
def test_one_feature_changes_in_many_random_fields(dim, n_fields):
    for seed in range(1000, 1000 + n_fields):
        check_wishes(seed, dim, 8 - dim, mesh_every=6)


@pytest.mark.parametrize("dim", [2, 3])
def test_a_part_is_separated_at_all_of_its_joints(dim):
    """Two bars are joined by three emptier cells with gaps between, which makes two holes."""
    cells = np.ones((7, 7, 3)[:dim])
    cells[3] = 0.0
    cells[3, 1::2] = 0.6
    cells[:3] = 0.9
    cell_sets = CellSets(fractions_of(cells))
    start = cell_sets.at(0.5).predicted
    assert start.betti_0 == 1
    assert start.betti_1 == 2
    found = change(cell_sets, [Feature(do="open", kind="component", near=(1, 3, 1)[:dim])])
    assert tuple(found.predicted) == (2, 0, 0)
    assert not found.kept[3].any()
    (row,) = found.changes.to_dict("records")
    assert (row["do"], row["class"], row["cells"]) == ("open", "component", 3 if dim == 2 else 9)
    wishes = [
        Feature(do="open", kind="component", near=(1, 3, 1)[:dim]),
        Feature(do="open", kind="hole", near=(3.5, 2.5, 1)[:dim]),
    ]
    with pytest.raises(TopologyError, match="ends with another wish"):
        change(cell_sets, wishes)


SQUARES = [[0, 0], [4, 0], [4, 4], [0, 4], [4.3, 0], [8.3, 0], [8.3, 4], [4.3, 4]]
LINES = [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4]]


@pytest.fixture(scope="module")
def opened(tmp_path_factory):
    """Return two squares that are one part at 1/2 and kept apart, and the folder of all files."""
    folder = tmp_path_factory.mktemp("squares")
    result = tusqh.mesh(
        (np.array(SQUARES), np.array(LINES)),
        cells=16,
        placement="corner",
        features=[{"near": (6, 2), "class": "component", "do": "open"}],
        name="squares",
    )
    result.save(folder)
    return result, folder


def test_all_files_state_what_was_done(opened):
    result, folder = opened
    assert result.report.measured == (2, 0, 0)
    (row,) = pd.read_csv(folder / "changes.csv").to_dict("records")
    assert (row["change"], row["do"], row["class"]) == ("left out", "open", "component")
    assert pd.read_csv(folder / "diagram.csv")["dimension"][row["row"]] == 0
    assert row["cells"] <= 8
    assert row["volume"] == pytest.approx(row["cells"] * (8.3 / 16) ** 2)
    certificate = json.loads((folder / FILE_NAME).read_text())
    assert certificate["selection"]["features"] == [{"row": row["row"], "do": "open"}]
    assert certificate["selection"]["base"] == 0.5
    assert "open row 1: component" in certificate["selection"]["wanted"]


def test_prices_are_what_the_features_cost(opened):
    _, folder = opened
    prices = pd.read_csv(folder / "prices.csv")
    diagram = pd.read_csv(folder / "diagram.csv")
    assert (
        diagram.loc[prices["row"], ["birth", "death"]].values == prices[["birth", "death"]]
    ).all(axis=None)
    assert prices.loc[~prices["possible"], "why"].notna().all()
    possible = prices[prices["possible"]].to_dict("records")
    assert {price["do"] for price in possible} >= {"open"}
    for price in possible[:4]:
        wish = {key: price[key] for key in ("row", "do")}
        result = tusqh.mesh(
            (np.array(SQUARES), np.array(LINES)), cells=16, placement="corner", features=[wish]
        )
        (change,) = result.built.changes.to_dict("records")
        for key in ("do", "change", "class", "cells", "volume"):
            assert change[key] == price[key]
        effect = np.subtract(result.report.measured, (1, 0, 0))
        assert [price[f"betti_{k}"] for k in range(3)] == effect.tolist()


def test_the_check_repeats_the_features(opened, tmp_path):
    _, folder = opened
    done = CliRunner().invoke(app, ["check", str(folder / "mesh.vtu")])
    assert done.exit_code == 0, done.output
    for path in folder.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    stored = json.loads((tmp_path / FILE_NAME).read_text())
    stored["selection"]["features"] = []
    (tmp_path / FILE_NAME).write_text(canonical_json(stored))
    mesh = tmp_path / "mesh.vtu"
    checks = check_certificate(tmp_path / FILE_NAME, mesh, read_vtu(mesh))
    assert "certificate_cells" in [check.id for check in checks if not check.holds]


def test_options_arguments_and_configuration_name_features_alike():
    block = {
        "features": [
            {"row": 3, "do": "open"},
            {"do": "cut", "near": [-1.5, 2], "class": "component"},
            {"do": "fill", "near": [0, 0, 1e-7], "class": "hole"},
        ]
    }
    options = {"open": ["3"], "cut": ["component@-1.5,2"], "fill": ["hole@0,0,1e-7"]}
    settings = Settings.from_dict(block)
    assert from_options(Settings, options) == settings
    assert to_words(settings) == [*("--open=3", "--cut=component@-1.5,2", "--fill=hole@0,0,1e-07")]
    assert Settings.from_dict(settings.to_dict()) == settings


@pytest.mark.parametrize(
    ("block", "message"),
    [
        ({"do": "cut"}, "neither `row` nor `near`"),
        ({"do": "cut", "row": 1, "near": [0, 0]}, "`row` and `near` are given"),
        ({"do": "cut", "near": [0, 0]}, "`near` without `class`"),
        ({"do": "drop", "row": 1}, "open, cut, fill"),
        ({"do": "cut", "class": "part", "near": [0, 0]}, "component, hole, void"),
        ({"do": "cut", "class": "hole", "near": [0]}, "2 to 3 entries"),
        ({"do": "cut", "row": -1}, "at least 0"),
    ],
)
def test_a_wish_that_is_not_one_is_refused(block, message):
    with pytest.raises(ConfigError, match=message):
        Settings.from_dict({"features": [block]})


@pytest.mark.parametrize("text", ["hole", "hole@", "hole@1,x", "3.5"])
def test_an_option_that_names_no_feature_is_refused(text):
    with pytest.raises(ConfigError, match=r"--fill[\s\S]*hole@0.5,1,2"):
        from_options(Settings, {"fill": [text]})


def test_features_beside_another_goal_are_refused():
    feature = {"row": 0, "do": "cut"}
    for other in ({"persistence": 0.2}, {"volume": "match"}):
        with pytest.raises(ConfigError, match="is given too"):
            Settings.from_dict({"features": [feature], **other})
    with pytest.raises(ConfigError, match="row 0 is in two wishes"):
        Settings.from_dict({"features": [feature, {"row": 0, "do": "fill"}]})


@pytest.fixture(scope="module")
def ring():
    """Return the cell sets of a ring with one hole, an island in it, and another part beside it."""
    cells = np.zeros((9, 13))
    cells[:, :9] = 1.0
    cells[1:-1, 1:8] = 0.0
    cells[4, 4] = 0.9
    cells[3:6, 11:] = 0.8
    return CellSets(fractions_of(cells))


@pytest.mark.parametrize(
    ("named", "message"),
    [
        ([{"row": 9, "do": "cut"}], r"row 9 of a diagram with 4 rows[\s\S]*row 0: component at"),
        (
            [{"row": 0, "class": "hole", "do": "cut"}],
            r"row 0 is a component, not a hole[\s\S]*row 3: hole at",
        ),
        ([{"near": [2, 2], "class": "void", "do": "cut"}], r"there is not a void at the threshold"),
        ([{"near": [2, 20], "class": "hole", "do": "cut"}], r"outside the grid[\s\S]*\(9, 13\)"),
        ([{"near": [2, 2, 2], "class": "hole", "do": "cut"}], "a point of 2 numbers"),
        (
            [
                {"near": [4, 1], "class": "hole", "do": "cut"},
                {"near": [3, 3], "class": "hole", "do": "fill"},
            ],
            "shall be both cut and fill",
        ),
        (
            [{"row": 0, "do": "cut"}, {"row": 3, "do": "open"}],
            r"row 3: hole[\s\S]*ends with another wish[\s\S]*cut row 0",
        ),
        ([{"row": k, "do": "cut"} for k in range(3)], "no cell would be left"),
        ([{"row": 0, "do": "fill"}], "it is the oldest component"),
    ],
)
def test_a_wish_that_cannot_be_met_says_why(ring, named, message):
    with pytest.raises(TopologyError, match=message):
        change(ring, [Feature.from_dict(about) for about in named])


def test_features_that_depend_on_one_another(ring):
    """The island goes with the hole that is filled; the ring takes its hole along."""
    both = change(ring, [Feature(do="fill", row=3), Feature(do="fill", row=1)])
    assert tuple(both.predicted) == (2, 0, 0)
    assert len(both.changes) == 1
    other = change(ring, [Feature(do="fill", row=1), Feature(do="fill", row=3)])
    assert tuple(other.predicted) == (2, 0, 0)
    assert (other.kept == both.kept).all()
    assert len(other.changes) == 2
    gone = change(ring, [Feature(do="cut", row=0)])
    assert tuple(gone.predicted) == (2, 0, 0)
    joined = change(ring, [Feature(do="fill", near=(4.5, 12), kind="component")])
    assert tuple(joined.predicted) == (2, 1, 0)
    assert joined.changes["cells"].tolist() == [2]


def test_a_mesh_with_local_scope_has_a_row_of_the_verification(opened):
    _, folder = opened
    row = json.loads((folder / "facts.json").read_text())["verification"]
    assert sorted(row) == sorted(VERIFICATION_COLUMNS)
    assert (row["scope"], row["holds"], row["cells_kept"]) == ("local", True, 128 - 8)
    for k in range(3):
        assert row[f"betti_{k}_predicted"] == row[f"betti_{k}_measured"] == (2, 0, 0)[k]
    plain = tusqh.mesh((np.array(SQUARES), np.array(LINES)), cells=16, placement="corner")
    assert "verification" not in plain.built.facts
