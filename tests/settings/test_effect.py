"""A remark names every setting that has no effect on a geometry."""

import dataclasses

import numpy as np
import pytest

import tusqh
from tusqh.errors import TopologyError
from tusqh.pipeline.ingest import read_source
from tusqh.pipeline.unused_settings import note_unused_settings
from tusqh.settings.arguments import from_options, options_of, to_words
from tusqh.settings.effect import find_without_effect
from tusqh.settings.model import Model, Settings
from tusqh.settings.section import Section

KINDS = ("outline", "surface", "image", "picture")
#: For every option of a mesh, a value that is not the default.
VALUES = {
    **{"cells": "9", "cell_size": "0.5", "placement": "corner", "samples": "6"},
    **{"domain": "outside", "rule": "clamped", "orientation": "flip", "sampler": "libigl"},
    **{"tolerance": "1e-3", "window": "0,0,1,1", "voxel_size": "2", "empty": "1", "full": "2"},
    **{"labels": "1", "channel": "0", "threshold": "0.25", "betti": "1,0", "persistence": "0.1"},
    **{"volume": True, "bridges": "none", "volume_tolerance": "0.1"},
    **{"voxels": "6,6,6", "voxel_order": "zyx"},
    **{"scope": "local", "base": "0.25", "open": ["0"], "cut": ["1"], "fill": ["hole@0,1"]},
    **{"checks": True, "fit": True, "slabs": "3", "inside": "union", "seal": "0.5"},
    **{"unit": "mm", "scale": "2", "convert_to": "m", "crs": "utm"},
    **{"coarsen": "interior", "thickness": "1 cell", "offset": "0.5,0.25,0", "snap": True},
    **{"rotate": "30,0,0", "align": "faces"},
    **{
        prefix + name: value
        for prefix in ("", "holes_", "voids_")
        for name, value in (
            *(("min_cells", "3"), ("min_volume", "0.1")),
            *(("min_persistence", "0.1"), ("keep", "1")),
        )
    },
}
#: What an option cannot be given without.
NEEDED = {"seal": {"inside": "envelope"}, "thickness": {"inside": "shell"}}
IMAGES = {"voxel_size", "empty", "full", "labels", "channel", "voxels", "voxel_order"}
SAMPLING = {"samples", "rule", "orientation", "sampler", "tolerance"}
SAMPLING |= {"inside", "seal", "thickness"}
HOLES, VOIDS = ({name for name in VALUES if name.startswith(p)} for p in ("holes_", "voids_"))
LOCAL = {"scope", "base"}  # They need a target or a persistence.
WITHOUT_EFFECT = {
    "outline": IMAGES | VOIDS | LOCAL,
    "surface": IMAGES | HOLES | LOCAL | {"crs"},
    "image": SAMPLING | HOLES | LOCAL | {"crs", "offset", "snap", "rotate", "align"},
    "picture": SAMPLING | VOIDS | LOCAL | {"crs", "offset", "snap", "rotate", "align"},
}


def geometry(kind):
    """Return a square with a notch, a box, or an image of one."""
    if kind == "outline":
        corners = [[0, 0], [3, 0], [3, 2], [1.5, 1.2], [0, 2]]
        return np.array(corners), np.array([[k, (k + 1) % 5] for k in range(5)])
    image = np.zeros((6, 6, 6), dtype=np.uint8)
    image[1:5, 1:4, 2:5] = 1
    if kind == "image":
        return image
    if kind == "picture":
        return image[:, :, 2]
    corners = np.array(np.unravel_index(range(8), (2, 2, 2))).T * (1.0, 2.0, 1.5)
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return corners, np.array(
        [[q[a], q[b], q[c]] for q in quads for a, b, c in ((0, 1, 2), (0, 2, 3))]
    )


def given(option):
    return from_options(Settings, {option: VALUES[option], **NEEDED.get(option, {})})


def test_every_option_is_tried():
    assert {option.name for option in options_of(Settings)} == set(VALUES)


@pytest.mark.parametrize("kind", KINDS)
def test_exactly_the_options_without_effect_are_named(kind):
    named = {option for option in VALUES if list(find_without_effect(given(option), kind))}
    assert named == WITHOUT_EFFECT[kind]


@pytest.mark.parametrize("kind", KINDS)
def test_every_option_that_is_named_leaves_the_mesh_unchanged(kind):
    source, plain = geometry(kind), {"cells": 6, "name": "part"}
    expected = tusqh.mesh(source, **plain)
    assert not any("without effect" in str(remark) for remark in expected.report.remarks)
    for option in sorted(WITHOUT_EFFECT[kind] - IMAGES - HOLES - VOIDS - {"crs"}):
        changed = given(option).to_dict(defaults=False)
        changed |= changed.pop("grid", {}) | {"cells": 6}
        arguments = {entry: value for entry, value in changed.items() if entry in VALUES}
        found = tusqh.mesh(source, **plain | arguments)
        assert any("without effect" in str(remark) for remark in found.report.remarks), option
        assert found.reading["remarks"][-1]["effect"] == "noted"
        assert np.array_equal(found.fractions.multiples, expected.fractions.multiples), option
        assert np.array_equal(found.mesh.cells, expected.mesh.cells), option


@pytest.mark.parametrize(
    ("kind", "section", "message"),
    [
        ("outline", "voids", "`voids` of a 2D model"),
        ("surface", "holes", "`holes` of a 3D model"),
        ("image", "holes", "`holes` of a 3D model"),
        ("picture", "voids", "`voids` of a 2D model"),
    ],
)
def test_criteria_for_features_of_the_other_dimension_are_refused(kind, section, message):
    with pytest.raises(TopologyError, match=message):
        tusqh.mesh(geometry(kind), cells=6, **{section: {"min_cells": 3}})


def test_the_default_is_never_named():
    assert [list(find_without_effect(Settings(), kind)) for kind in KINDS] == [[]] * len(KINDS)


def test_a_setting_that_needs_another_one_is_named_with_it():
    settings = Settings.from_dict({"sampler": "libigl", "tolerance": 1e-3})
    assert list(find_without_effect(settings, "surface")) == [
        "`tolerance` applies only with `sampler: crossings`"
    ]


def test_the_local_scope_needs_a_wish_for_a_topology():
    settings = Settings.from_dict({"threshold": 0.4, "scope": "local"})
    (sentence,) = find_without_effect(settings, "surface")
    assert sentence == "`scope` applies only with `target` or `persistence`"
    settings = Settings.from_dict({"target": {"betti_0": 1}, "base": "match"})
    assert list(find_without_effect(settings, "surface")) == []
    settings = Settings.from_dict({"target": {"betti_0": 1}, "scope": "global", "base": "match"})
    (sentence,) = find_without_effect(settings, "surface")
    assert sentence == "`base` applies only with `scope: local`"
    settings = Settings.from_dict({"volume": "match", "base": 0.4})
    (sentence,) = find_without_effect(settings, "surface")
    assert sentence == "`base` applies only with `target` or `persistence` or `features`"


def test_the_panels_of_a_model_apply_to_outlines():
    model = Model.from_dict({"geometry": "a.stl", "panels": [0.5, 0.4, 0.3]})
    assert list(find_without_effect(model, "surface")) == [
        "`panels` applies only to outlines and pictures"
    ]


def test_the_remark_says_what_to_do():
    settings = Settings.from_dict({"image": {"channel": 1}})
    reading = note_unused_settings(read_source(geometry("surface")), settings)
    assert str(reading.remarks[-1]) == (
        "noted: 1 setting without effect: `image.channel` applies only to images and pictures "
        "(remove it)"
    )


def test_every_kind_that_a_field_names_exists():
    def kinds_of(section):
        for field in dataclasses.fields(section):
            yield from field.metadata["setting"].kinds
            value = getattr(section, field.name)
            if isinstance(value, Section):
                yield from kinds_of(value)

    assert set(kinds_of(Model(geometry="a.stl"))) == set(KINDS)
    assert to_words(Settings()) == []
