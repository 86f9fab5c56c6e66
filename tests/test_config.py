"""Configuration errors name file, key, what was found, what is allowed and the nearest key."""

import pytest
import yaml

from tusqh.config import load_config
from tusqh.errors import ConfigError


def load(repository, tmp_path, text):
    path = tmp_path / "config.yaml"
    path.write_text(text)
    try:
        merged = yaml.safe_load(text)
    except yaml.YAMLError:
        merged = {}
    return load_config([path], repository / "workflow/schemas/config.schema.yaml", merged)


def test_defaults_are_filled_in(repository, tmp_path):
    config = load(repository, tmp_path, "models: {a: {geometry: a.svg}}")
    model = config["models"]["a"]
    assert model["threshold"] == 0.5
    assert model["grid"] == {"cells": 64}
    assert model["simulation"] == {"amount": 1000, "refinements": 0}
    assert config["sweep"] == [0.9, 0.75, 0.5, 0.25, 0.15, 0.05, 0.01]
    assert model["bridges"] == "forest"
    assert model["components"] == model["holes"] == {}
    by_topology = "models: {a: {geometry: a.svg, target: {betti_1: 2}}}"
    assert "threshold" not in load(repository, tmp_path, by_topology)["models"]["a"]


def test_the_committed_configuration_is_valid(repository, tmp_path):
    text = (repository / "config/config.yaml").read_text()
    models = load(repository, tmp_path, text)["models"]
    assert models["chesapeake"]["grid"] == {"cells": [60, 79]}
    assert models["chesapeake_fine"]["grid"] == {"cells": [120, 158]}


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("models: {a: {geometri: a.svg}}", ["models.a", "'geometri'", "did you mean 'geometry'"]),
        ("models: {a: {geometry: a.svg, sampels: 4}}", ["'sampels'", "did you mean 'samples'"]),
        ("models: {a: {}}", ["models.a", "'geometry' is missing"]),
        ("modles: {}", ["the top level", "'modles'", "did you mean 'models'"]),
        ("models: {a: {geometry: a.svg, samples: 3}}", ["a.samples", "found 3", "multiple of 2"]),
        ("models: {a: {geometry: a.svg, samples: 0}}", ["a.samples", "found 0", "at least 2"]),
        ("models: {a: {geometry: a.svg, threshold: 0}}", ["a.threshold", "found 0", "more than 0"]),
        ("models: {a: {geometry: a.svg, threshold: 1.5}}", ["found 1.5", "at most 1"]),
        ("models: {a: {geometry: a.svg, domain: outsied}}", ["one of", "did you mean 'outside'"]),
        ("models: {a: {geometry: a.svg, window: {lower: [0, 0]}}}", ["window", "'upper'"]),
        ("models: {a: {geometry: a.svg, grid: {cells: 0}}}", ["a.grid.cells", "found 0"]),
        ("models: {'../b': {geometry: a.svg}}", ["'../b'", "no plain file name"]),
        ("models: {'a b': {geometry: a.svg}}", ["'a b'", "no plain file name"]),
        ("models: {tables: {geometry: a.svg}}", ["'tables'", "reserved"]),
        ("models: {}", ["models"]),
        (
            "models: {a: {geometry: a.svg, target: {betti_1: {min: 3, max: 1}}}}",
            ["models.a.target.betti_1", "min is not above its max"],
        ),
        (
            "models: {a: {geometry: a.svg, threshold: 0.5, target: {betti_0: 1}}}",
            ["models.a", "`threshold` and `target` are given", "one of them"],
        ),
        (
            "models: {a: {geometry: a.svg, target: {betti_1: two}}}",
            ["a.target.betti_1", "found 'two'", "a list of numbers"],
        ),
        (
            "models: {a: {geometry: a.svg, target: {betti_1: {least: 1}}}}",
            ["a.target.betti_1", "'least'", "max, min"],
        ),
        (
            "models: {a: {geometry: a.svg, holes: {min_cell: 3}}}",
            ["a.holes", "'min_cell'", "did you mean 'min_cells'"],
        ),
        ("models: {a: {geometry: a.svg, persistence: 0}}", ["a.persistence", "more than 0"]),
        ("models: {a: {geometry: a.svg, bridges: tree}}", ["a.bridges", "forest"]),
        ("models:\n  a: {geometry: a.svg}\n  a: {geometry: b.svg}", ["'a' stands twice", "line 3"]),
        (
            "models:\n  a: {geometry: a.svg}\n  A: {geometry: b.svg}",
            ["'a' and 'A'", "upper and lower case"],
        ),
        (
            "models: {a: {geometry: a.tif, image: {voxel: 3}}}",
            ["a.image", "'voxel'", "did you mean 'voxel_size'"],
        ),
        ("models: {a: {geometry: a.tif, image: {voxel_size: 0}}}", ["found 0", "more than 0"]),
        ("models: {a: {geometry: a.tif, image: 3}}", ["a.image", "found 3"]),
        ("models: [1, 2", ["cannot be read"]),
        ("- just\n- a list", ["holds ['just', 'a list']"]),
    ],
)
def test_mistakes_are_explained(repository, tmp_path, text, parts):
    with pytest.raises(ConfigError) as caught:
        load(repository, tmp_path, text)
    message = str(caught.value)
    assert "config.yaml" in message
    for part in parts:
        assert part in message
