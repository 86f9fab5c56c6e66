"""Configuration errors name file, key, what was found, what is allowed and the nearest key."""

import pytest
import yaml

from tusqh.errors import ConfigError
from tusqh.settings.goal import Goal, Target
from tusqh.settings.grid import Grid
from tusqh.settings.load import load_config
from tusqh.settings.policy import Policy
from tusqh.settings.simulation import Simulation


def load(tmp_path, text, **given):
    path = tmp_path / "config.yaml"
    path.write_text(text)
    try:
        merged = yaml.safe_load(text)
    except yaml.YAMLError:
        merged = {}
    return load_config([path], merged, **given)


def test_defaults_are_filled_in(tmp_path):
    config = load(tmp_path, "models: {a: {geometry: a.svg}}")
    model = config.models["a"]
    assert model.settings.goal == Goal(threshold=0.5)
    assert model.settings.grid == Grid(cells=64)
    assert model.settings.policy == Policy()
    assert model.simulation == Simulation(amount=1000.0)
    assert config.sweep == (0.9, 0.75, 0.5, 0.25, 0.15, 0.05, 0.01)
    assert config.study.seconds == 90
    by_topology = load(tmp_path, "models: {a: {geometry: a.svg, target: {betti_1: 2}}}")
    assert by_topology.models["a"].settings.goal == Goal(target=Target(betti_1=2))


def test_the_committed_configuration_is_valid(repository, tmp_path):
    models = load(tmp_path, (repository / "config/config.yaml").read_text()).models
    assert models["chesapeake"].settings.grid.cells == (60, 79)
    assert models["chesapeake_fine"].settings.grid.cells == (120, 158)


def test_numbers_on_the_command_line_of_snakemake_are_numbers(tmp_path):
    text = "models: {a: {geometry: a.svg, grid: {cells: 8}}}"
    given = {"models": {"a": {"simulation": {"diffusivity": "2"}, "panels": ["1", "0.5", ".2"]}}}
    given["study"] = {"seconds": "7"}
    config = load(tmp_path, text, given=given)
    assert config.models["a"].simulation.diffusivity == 2.0
    assert config.models["a"].panels == (1.0, 0.5, 0.2)
    assert config.models["a"].settings.grid == Grid(cells=8)
    assert config.study.seconds == 7


@pytest.mark.parametrize(
    ("given", "parts"),
    [
        ({"study": {"seconds": "0"}}, ["from --config: study.seconds: found 0", "at least 1"]),
        (
            {"study": {"peers": ["b"]}},
            ["from --config: study.peers: unknown model 'b'", "expected: one of a"],
        ),
        ({"study": {"second": "9"}}, ["from --config: study.second", "did you mean 'seconds'?"]),
        (
            {"models": {"a": {"threshold": "0.5"}}},
            ["from --config: models.a.threshold and ", "config.yaml: models.a.target", "both are"],
        ),
    ],
)
def test_mistakes_on_the_command_line_of_snakemake_are_explained(tmp_path, given, parts):
    text = "models: {a: {geometry: a.svg, target: {betti_0: 1}}}"
    with pytest.raises(ConfigError) as caught:
        load(tmp_path, text, given=given)
    assert all(part in str(caught.value) for part in parts)


def test_the_file_that_holds_the_mistake_is_named(tmp_path):
    files = {"above.yaml": {"models": {"a": {"grid": {"cells": 0}}}}, "below.yaml": {}}
    files["below.yaml"] = {"models": {"a": {"geometry": "a.svg", "grid": {"cells": 8}}}}
    for name, content in files.items():
        (tmp_path / name).write_text(yaml.safe_dump(content))
    merged = {"models": {"a": {"geometry": "a.svg", "grid": {"cells": 0}}}}
    with pytest.raises(ConfigError) as caught:
        load_config([tmp_path / name for name in files], merged)
    assert "above.yaml: models.a.grid.cells: found 0" in str(caught.value)
    assert "below.yaml" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("models: {a: {geometri: a.svg}}", ["models.a", "'geometri'", "did you mean 'geometry'"]),
        ("models: {a: {geometry: a.svg, sampels: 4}}", ["'sampels'", "did you mean 'samples'"]),
        ("models: {a: {}}", ["models.a", "'geometry' is missing"]),
        ("modles: {}", ["'modles'", "did you mean 'models'"]),
        ("models: {a: {geometry: a.svg, samples: 3}}", ["a.samples", "found 3", "divisible by 2"]),
        ("models: {a: {geometry: a.svg, samples: 0}}", ["a.samples", "found 0", "at least 2"]),
        ("models: {a: {geometry: a.svg, threshold: 0}}", ["a.threshold", "found 0", "above 0"]),
        ("models: {a: {geometry: a.svg, threshold: 1.5}}", ["found 1.5", "at most 1"]),
        ("models: {a: {geometry: a.svg, domain: outsied}}", ["one of", "did you mean 'outside'"]),
        ("models: {a: {geometry: a.svg, window: {lower: [0, 0]}}}", ["window", "'upper'"]),
        ("models: {a: {geometry: a.svg, grid: {cells: 0}}}", ["a.grid.cells", "found 0"]),
        ("models: {'../b': {geometry: a.svg}}", ["'../b'", "not a plain file name"]),
        ("models: {'a b': {geometry: a.svg}}", ["'a b'", "not a plain file name"]),
        ("models: {tables: {geometry: a.svg}}", ["'tables'", "reserved"]),
        ("models: {}", ["models", "at least one entry"]),
        ("models: {a: {geometry: a.svg, samples: }}", ["a.samples", "no value is given"]),
        ("models: {a: {geometry: a.svg, target: {}}}", ["a.target", "at least one of betti_0"]),
        ("models: {a: {geometry: a.svg, grid: {cells: 4, cell_size: 1}}}", ["both are given"]),
        ("models: {a: {geometry: a.svg, window: {lower: [0, 0], upper: [1, 0]}}}", ["above"]),
        (
            "models: {a: {geometry: a.svg, target: {betti_1: {min: 3, max: 1}}}}",
            ["models.a.target.betti_1", "min is not above its max"],
        ),
        (
            "models: {a: {geometry: a.svg, threshold: 0.5, target: {betti_0: 1}}}",
            ["models.a.threshold and ", "models.a.target: both are given", "one of the two"],
        ),
        (
            "models: {a: {geometry: a.svg, target: {betti_1: two}}}",
            ["a.target.betti_1", "found 'two'", "a list of entries", "min, max"],
        ),
        (
            "models: {a: {geometry: a.svg, target: {betti_1: {least: 1}}}}",
            ["a.target.betti_1", "'least'", "max, min"],
        ),
        (
            "models: {a: {geometry: a.svg, holes: {min_cell: 3}}}",
            ["a.holes", "'min_cell'", "did you mean 'min_cells'"],
        ),
        ("models: {a: {geometry: a.svg, persistence: 0}}", ["a.persistence", "above 0"]),
        ("models: {a: {geometry: a.svg, bridges: tree}}", ["a.bridges", "forest"]),
        (
            "models:\n  a: {geometry: a.svg}\n  a: {geometry: b.svg}",
            ["duplicate key 'a'", "line 3"],
        ),
        (
            "models:\n  a: {geometry: a.svg}\n  A: {geometry: b.svg}",
            ["'a' and 'A'", "upper and lower case"],
        ),
        (
            "models: {a: {geometry: a.tif, image: {voxelsize: 3}}}",
            ["a.image", "'voxelsize'", "did you mean 'voxel_size'"],
        ),
        ("models: {a: {geometry: a.tif, image: {voxel_size: 0}}}", ["found 0", "above 0"]),
        ("models: {a: {geometry: a.tif, image: 3}}", ["a.image", "found 3"]),
        ("models: [1, 2", ["cannot be read"]),
        ("- just\n- a list", ["contains ['just', 'a list']"]),
    ],
)
def test_mistakes_are_explained(tmp_path, text, parts):
    with pytest.raises(ConfigError) as caught:
        load(tmp_path, text)
    message = str(caught.value)
    assert "config.yaml" in message
    for part in parts:
        assert part in message
