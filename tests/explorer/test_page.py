import base64
import hashlib
import json
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from subjects import make_subject, noise

from tusqh.errors import ConfigError
from tusqh.explorer import assets
from tusqh.explorer.command import Command, mesh_command
from tusqh.explorer.files_read import FILES_READ
from tusqh.explorer.page import make_page, to_script_json
from tusqh.explorer.subject import read_subject
from tusqh.files import path_of
from tusqh.geometry.upright import upright_axis
from tusqh.settings.model import Settings

ALL_SCRIPTS = {*assets.SCRIPTS, *assets.SCRIPTS_OF_MATERIALS}


@pytest.fixture(scope="module")
def page():
    return make_page(make_subject(noise(np.random.default_rng(1), (4, 3, 2))))


def test_a_page_is_the_same_every_time(page):
    assert page == make_page(make_subject(noise(np.random.default_rng(1), (4, 3, 2))))


def test_a_page_names_no_other_file(page):
    ours = page.replace(assets.read_asset(assets.THREE), "")
    assert not re.search(r"<(link|img|iframe|object|embed|base)\b|\bsrc=|@import|url\(", ours)
    assert not re.search(r"fetch\(|XMLHttpRequest|WebSocket|import\(|importScripts", ours)
    assert "Permission is hereby granted, free of charge" in page  # The licence of three.js.


def test_the_policy_allows_exactly_the_two_scripts_of_the_page(page):
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', page)[1]
    allowed = re.findall(r"'sha256-([^']*)'", policy)
    scripts = re.findall(r"<script>(.*?)</script>", page, flags=re.DOTALL)
    digests = [base64.b64encode(hashlib.sha256(s.encode()).digest()).decode() for s in scripts]
    assert len(scripts) == 2
    assert digests == allowed
    assert policy.startswith("default-src 'none';")


@pytest.mark.parametrize(
    "name", [assets.THREE, *(f"page/{name}.js" for name in sorted(ALL_SCRIPTS))]
)
def test_scripts_do_not_end_their_element(name):
    text = assets.read_asset(name)
    assert "</script" not in text.lower()
    assert "<!--" not in text


def test_every_script_is_read(repository):
    files = {path.stem for path in (repository / "tusqh/explorer/page").glob("*.js")}
    assert files == ALL_SCRIPTS


@given(st.recursive(st.text() | st.floats(allow_nan=False, allow_infinity=False), st.lists))
def test_json_comes_back_and_never_holds_markup(value):
    text = to_script_json(value)
    assert "<" not in text
    assert json.loads(text) == value


def test_colours_are_those_of_the_figures():
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    from tusqh.figures import style

    script = assets.read_asset("page/colours.js")
    ours = dict(re.findall(r"(\w+): '(#\w{6})'", script))
    assert ours["material"] == style.MATERIAL
    assert ours["separating"] == style.SEPARATING
    assert ours["connecting"] == style.CONNECTING
    assert ours["bridge"] == style.BRIDGE
    of_dimensions = re.search(r"DIMENSION_COLOURS = \[(.*?)\]", script)[1]
    assert re.findall(r"#\w{6}", of_dimensions) == list(style.DIMENSION_COLOURS)
    ramp = re.findall(r"#\w{6}", re.search(r"RAMP = \[(.*?)\]", script, re.DOTALL)[1])
    assert ramp == [to_hex(colormaps["cividis"](i / 8)) for i in range(9)]


@pytest.mark.parametrize(
    ("block", "words"),
    [
        ({}, "--cells 64"),
        ({"grid": {"cells": [60, 79]}}, "--cells 60,79"),
        ({"grid": {"cell_size": 0.5}, "samples": 6}, "--cell-size 0.5 --samples 6"),
        (
            {"window": {"lower": [-1, 0.0], "upper": [2, 3.5]}, "domain": "outside"},
            "--cells 64 --domain outside --window=-1,0,2,3.5",
        ),
        (
            {"image": {"voxel_size": 0.5, "full": 255}},
            "--cells 64 --voxel-size 0.5 --full 255",
        ),
        (
            {"components": {"min_cells": 4}, "samples": 4},
            "--cells 64 --min-cells 4",
        ),
        (
            {"components": {"keep": 2}, "voids": {"min_cells": 2}, "sampler": "libigl"},
            "--cells 64 --sampler libigl --keep 2 --voids-min-cells 2",
        ),
        ({"target": {"betti_0": 1}}, "--cells 64"),
    ],
)
def test_the_command_says_what_differs_from_the_defaults(block, words):
    command = mesh_command("p.stl", Settings.from_dict(block), name="p")
    goal = "--betti '1,*,*'" if "target" in block else ""  # It makes the final mesh.
    assert command == Command(f"tusqh mesh p.stl {words}", "-o p.vtu", goal)


def test_names_are_quoted_for_the_shell():
    command = mesh_command("a b; rm -rf.stl", Settings(), name="$(x)")
    assert command.before.startswith("tusqh mesh 'a b; rm -rf.stl' ")
    assert command.after == "-o '$(x).vtu'"


def test_the_format_tells_the_upright_axis():
    axes = [upright_axis(f"a.{suffix}") for suffix in ("obj", "glb", "stl", "svg")]
    assert axes == ["y", "y", "z", "z"]
    assert upright_axis("a.obj", "x") == "x"


def test_a_folder_without_results_says_what_is_missing(tmp_path):
    (tmp_path / "mesh.vtu").touch()
    with pytest.raises(ConfigError) as error:
        read_subject(tmp_path)
    assert "geometry.vtp, fractions.npz" in str(error.value)
    named = set(re.findall(r"[\w-]+\.\w+", str(error.value).splitlines()[0]))
    assert named >= {path_of(name, tmp_path).name for name in FILES_READ} - {"mesh.vtu"}
    assert "mesh.vtu" not in named
