"""Single features of one of several materials are opened, cut and filled, and nothing else."""

import json

import numpy as np
import pandas as pd
import pytest
from random_materials import random_materials
from test_relabel import is_simple, smooth_materials
from typer.testing import CliRunner

import tusqh
from tusqh.cli.app import app
from tusqh.contacts import MaterialFractions
from tusqh.contacts.decide import decide_contacts
from tusqh.contacts.label_contacts import find_votes
from tusqh.contacts.mesh import mesh_materials, round_thresholds
from tusqh.errors import ConfigError, TopologyError
from tusqh.hashing import canonical_json
from tusqh.local_topology.changeable import Impossible
from tusqh.local_topology.local_labels import MaterialWish, label_locally, to_labels
from tusqh.local_topology.material_features import MaterialFeatures
from tusqh.local_topology.wishes import CUT, FILL, OPEN, Wish
from tusqh.settings.arguments import from_options, to_words
from tusqh.settings.model import Settings


def some_features(seed, dim, largest):
    """Return the classes of all materials of a random field at random thresholds."""
    rng = np.random.default_rng(seed)
    if seed % 2:
        fractions = smooth_materials(rng, dim, largest)
    else:
        fractions, _ = random_materials(seed, dim, largest)
    named = dict(zip(fractions.names, (0.2 + 0.8 * rng.random(20)).tolist(), strict=False))
    thresholds = round_thresholds(fractions.names, named)
    return MaterialFeatures(fractions, thresholds, fractions.names[:-1]), named


def check_wishes(seed, dim, largest):
    """Do everything possible to every class; return how many wishes were met, of how many."""
    features, named = some_features(seed, dim, largest)
    fractions, start, n_met, n = features.fractions, features.start(), 0, 0
    void = fractions.void
    for row, about in enumerate(features.classes.itertuples()):
        k = about.number
        for do in (CUT, FILL) if about.is_there else (OPEN,):
            n += 1
            try:
                done = features.apply(start, Wish(row, do))
            except Impossible:
                continue
            n_met += 1
            mesh = mesh_materials(fractions, thresholds=named, labels=done.labels, with_void=True)
            assert mesh.is_as_predicted
            found = [n for name in fractions.names for n in mesh.predicted[name]]
            assert tuple(found) == done.betti
            effect = np.subtract(done.of(k), start.of(k))
            assert effect[about.dimension] == 1 if do == OPEN else effect[about.dimension] <= -1
            is_whole = (do, about.dimension) in ((CUT, 0), (FILL, dim - 1))
            if do == OPEN and about.dimension == 0:
                assert (effect[1:] <= 0).all()  # Loops through its joints end.
            elif not is_whole:
                assert np.abs(effect).sum() == 1
            for j in range(void):
                assert is_whole or j == k or done.of(j) == start.of(j)
            changed = done.labels != start.labels
            assert k in done.labels
            assert changed.any()
            assert ((done.labels == k) | (start.labels == k))[changed].all()
            local = to_labels(features, done, ())
            is_left = local.labels != local.base
            assert (local.labels[is_left] == done.labels[is_left]).all()
            assert local.changes["cells"].sum() == is_left.sum() > 0
            for cell in map(tuple, np.argwhere(is_left).tolist()):
                goal = local.base[cell]
                assert not is_simple(fractions, local.labels, features.thresholds, cell, goal)
    return n_met, n


@pytest.mark.parametrize(("dim", "largest", "n_fields"), [(2, 6, 6), (3, 3, 4)])
def test_one_feature_of_a_material_changes(dim, largest, n_fields):
    n_met, n = np.sum([check_wishes(seed, dim, largest) for seed in range(n_fields)], axis=0)
    assert n > n_met > 2 * n_fields


@pytest.mark.slow
@pytest.mark.parametrize(("dim", "largest", "n_fields"), [(2, 6, 600), (3, 3, 300)])
def test_one_feature_of_a_material_changes_in_many_fields(dim, largest, n_fields):
    counts = [check_wishes(seed, dim, largest) for seed in range(1000, 1000 + n_fields)]
    n_met, n = np.sum(counts, axis=0)
    print(f"{n_met} of {n} wishes are met")
    assert n_met > 5 * n_fields


def test_votes_are_those_of_the_mesh():
    for seed in range(20):
        fractions, named = random_materials(seed, 2 + seed % 2, 4)
        t = round_thresholds(fractions.names, named)
        decision = decide_contacts(fractions, fractions.label_cells(t), t)
        padded = np.ascontiguousarray(decision.labels, dtype=np.int32)
        found = find_votes(fractions, padded, t)
        for name, wanted in vars(decision.contacts).items():
            assert np.array_equal(getattr(found, name), wanted), (seed, name)


def frame(dim=2):
    """Return a frame around a hole that holds a ball, and a loose piece of the frame."""
    ring = np.zeros((11, 14))
    ring[1:10, 1:10] = 1
    ring[3:8, 3:8] = 0
    ring[5:7, 12] = 0.8
    ball = np.zeros_like(ring)
    ball[4:6, 4:6] = 1
    cells = {"ring": ring, "ball": ball}
    if dim == 3:
        cells = {k: np.stack([v * 0, v, v, v * 0], axis=2) for k, v in cells.items()}
    return MaterialFractions.from_cells(cells)


HOLE = {"material": "ring", "near": (6.5, 6.5), "class": "hole"}


@pytest.mark.parametrize(
    ("features", "targets", "ring", "ball"),
    [
        ([HOLE | {"do": "cut"}], {}, (2, 0, 0), (1, 0, 0)),
        ([{"material": "ring", "row": 1, "do": "cut"}], {}, (1, 1, 0), (1, 0, 0)),
        ([], {"ring": (1, 1)}, (1, 1, 0), (1, 0, 0)),
        ([], {"ring": (1, 0), "ball": (1, 0)}, (1, 0, 0), (1, 0, 0)),
        ([HOLE | {"do": "cut"}], {"ring": (1, 0)}, (1, 0, 0), (1, 0, 0)),
    ],
)
def test_wishes_and_targets_of_several_materials(tmp_path, features, targets, ring, ball):
    found = tusqh.mesh(frame(), materials=targets or "parts", features=features or None)
    assert found.is_as_predicted
    assert found.built.predicted["ring"] == ring
    assert found.built.predicted["ball"] == ball
    assert found.local.n_changes == found.changes["cells"].sum() > 0
    assert ((found.changes["from"] == "ring") | (found.changes["to"] == "ring")).all()
    found.save(tmp_path)
    done = CliRunner().invoke(app, ["check", str(tmp_path / "mesh.vtu")])
    assert done.exit_code == 0, done.output
    stored = json.loads((tmp_path / "certificate.json").read_text())
    assert stored["changed_cells"] == found.local.n_changes
    assert len(stored["features"]) == len(found.local.wishes)
    table = pd.read_csv(tmp_path / "changes.csv")
    assert list(table.columns[:4]) == ["from", "to", "cells", "volume"]


def test_the_hole_is_filled_in_space_and_holds_no_cell_of_the_ball():
    """In the plane the ball would have to go; in space a plate closes the hole over it."""
    with pytest.raises(TopologyError, match="no cell of ball would be left"):
        tusqh.mesh(frame(), materials="parts", features=[HOLE | {"do": "fill"}])
    in_space = HOLE | {"do": "fill", "near": (6.5, 6.5, 1.5)}
    found = tusqh.mesh(frame(3), materials="parts", features=[in_space])
    assert found.is_as_predicted
    assert found.built.predicted["ring"] == (2, 0, 0)
    assert found.built.predicted["ball"] == (1, 0, 0)
    assert found.part("ball").volumes.sum() == 8


def test_prices_are_what_the_features_of_materials_cost():
    fractions = frame()
    plain = tusqh.mesh(fractions, materials="parts")
    assert len(plain.changes) == 0
    possible = plain.prices[plain.prices["possible"]]
    assert len(possible) >= 4
    volumes = plain.materials.set_index("material")["volume_of_geometry"]
    assert set(volumes.index) == {"ring", "ball", "all"}
    for price in possible.to_dict("records"):
        wish = {key: price[key] for key in ("material", "row", "do")}
        found = tusqh.mesh(fractions, materials="parts", features=[wish])
        assert found.local.n_changes == price["cells"]
        before, after = (
            np.bincount(labels.ravel(), minlength=3)
            for labels in (found.local.base, found.local.labels)
        )
        names = fractions.names
        words = [f"{names[k]} {after[k] - before[k]:+d}" for k in range(3) if after[k] != before[k]]
        assert price["volumes"] == ", ".join(words)
        effect = np.subtract(
            found.built.predicted[price["material"]], plain.built.predicted[price["material"]]
        )
        assert [price[f"betti_{k}"] for k in range(3)] == effect.tolist()
    assert (plain.prices.loc[~plain.prices["possible"], "why"] != "").all()


def test_targets_keep_the_materials_of_the_base():
    """A lower threshold closes a gap in a wall and thickens it; only the gap stays closed."""
    wall = np.zeros((9, 9))
    wall[:, 4] = 1
    wall[4, 4] = 0.3
    wall[:, 5] = 0.3
    wall[:, 3] = 0.2
    cells = {"wall": wall, "soil": 1 - wall}
    fractions = MaterialFractions.from_cells(cells)
    local = tusqh.mesh(fractions, materials={"wall": (1, 0)})
    one = tusqh.mesh(fractions, materials={"wall": (1, 0)}, scope="global")
    assert local.built.predicted["wall"] == one.built.predicted["wall"] == (1, 0, 0)
    assert local.thresholds == one.thresholds
    assert one.local is None
    assert local.local.n_changes == 1
    assert local.changes[["from", "to"]].values.tolist() == [["soil", "wall"]]
    assert np.bincount(local.local.labels.ravel())[0] == 9
    assert one.part("wall").volumes.sum() > 1.5 * local.part("wall").volumes.sum()


def test_the_check_repeats_the_changes(tmp_path):
    found = tusqh.mesh(frame(), materials="parts", features=[HOLE | {"do": "cut"}])
    found.save(tmp_path)
    path = tmp_path / "certificate.json"
    stored = json.loads(path.read_text())
    for change in ({"features": []}, {"changed_cells": 1}):
        path.write_text(canonical_json(stored | change))
        done = CliRunner().invoke(app, ["check", str(tmp_path / "mesh.vtu")])
        assert done.exit_code == 1
    wishes = [MaterialWish("ring", 99, "cut")]
    path.write_text(canonical_json(stored | {"features": [w._asdict() for w in wishes]}))
    done = CliRunner().invoke(app, ["check", str(tmp_path / "mesh.vtu")])
    assert done.exit_code == 1
    assert "cannot be repeated" in done.output


def test_repeated_labels_are_the_same():
    found = tusqh.mesh(frame(), materials={"ring": (1, 0)})
    again = label_locally(frame(), found.thresholds, found.base, found.local.wishes)
    assert np.array_equal(again.labels, found.local.labels)


@pytest.mark.parametrize(
    ("wish", "error", "message"),
    [
        (HOLE | {"material": "pin"}, ConfigError, "of 'pin'[\\s\\S]*ring, ball"),
        ({"row": 0, "do": "cut"}, ConfigError, "without a material"),
        ({"material": "ring", "row": 9, "do": "cut"}, TopologyError, "row 9 of a diagram with 3"),
        ({"material": "ball", "row": 0, "do": "cut"}, TopologyError, "no cell would be left"),
        (HOLE | {"class": "void"}, TopologyError, "there is not a void at the base"),
        (HOLE | {"near": (50, 0)}, TopologyError, "outside the grid"),
    ],
)
def test_a_wish_for_a_material_that_cannot_be_met_says_why(wish, error, message):
    with pytest.raises(error, match=message):
        tusqh.mesh(frame(), materials="parts", features=[{"do": "cut"} | wish])


def test_contradictory_wishes_for_materials():
    wishes = [
        {"material": "ring", "row": 1, "do": "cut"},
        {"material": "ring", "near": (5.5, 12.5), "class": "component", "do": "open"},
    ]
    with pytest.raises(TopologyError, match="shall be both cut and open"):
        tusqh.mesh(frame(), materials="parts", features=wishes)


def test_a_target_that_neither_thresholds_nor_features_reach():
    with pytest.raises(TopologyError, match=r"no features opened[\s\S]*nearest found with feat"):
        tusqh.mesh(frame(), materials={"ring": (5, 7)})
    with pytest.raises(TopologyError, match="a material has at least one component"):
        tusqh.mesh(frame(), materials={"ring": (0, 0)})
    with pytest.raises(TopologyError, match="no threshold gives") as caught:
        tusqh.mesh(frame(), materials={"ring": (1, 0)}, scope="global")
    assert "no features" not in str(caught.value)


def test_materials_are_named_alike_in_options_and_configuration():
    block = {
        "features": [
            {"material": "ring", "row": 3, "do": "open"},
            {"material": "a:b", "do": "fill", "near": [0, 0], "class": "hole"},
        ]
    }
    options = {"open": ["ring:3"], "fill": ["a:b:hole@0,0"]}
    settings = Settings.from_dict(block)
    assert from_options(Settings, options) == settings
    assert to_words(settings) == ["--open=ring:3", "--fill=a:b:hole@0,0"]


def test_a_material_named_for_one_material_is_refused():
    square = [[0, 0], [4, 0], [4, 4], [0, 4]]
    lines = [[0, 1], [1, 2], [2, 3], [3, 0]]
    wish = {"material": "ring", "row": 0, "do": "cut"}
    with pytest.raises(ConfigError, match="there is only one"):
        tusqh.mesh((np.array(square), np.array(lines)), cells=8, features=[wish])


def test_a_scope_without_targets_is_noted():
    found = tusqh.mesh(frame(), materials="parts", scope="local")
    assert "`scope` applies only where a material has a target" in str(found.remarks[-1])
