"""Files generated from the fields of the settings are current."""

import inspect
from dataclasses import MISSING, dataclass
from typing import get_type_hints

import jsonschema
import pytest
import typer
import yaml
from numpydoc.docscrape import NumpyDocString
from typer.testing import CliRunner

import tusqh
from tusqh.cli.options import to_parameter, with_settings
from tusqh.settings.arguments import (
    arguments_of,
    from_arguments,
    from_options,
    options_of,
    to_words,
)
from tusqh.settings.field import setting
from tusqh.settings.model import Settings, Workflow
from tusqh.settings.policy import Policy
from tusqh.settings.schema import schema_of
from tusqh.settings.section import Section
from tusqh.settings.tables import render_all, render_schema, to_table


def test_the_schema_and_the_tables_of_the_guide_are_current(repository):
    for path, text in render_all(repository).items():
        assert path.read_text(encoding="utf-8") == text, "run python -m tusqh.settings"


def test_the_schema_is_one_that_the_committed_configuration_follows(repository):
    schema = yaml.safe_load(render_schema(Workflow))
    jsonschema.Draft202012Validator.check_schema(schema)
    config = yaml.safe_load((repository / "config/config.yaml").read_text())
    jsonschema.Draft202012Validator(schema).validate(config)


def check_call(function, section):
    """Raise unless a function has exactly the arguments of a section, documented."""
    parameters = inspect.signature(function).parameters
    documented = {
        name
        for entry in NumpyDocString(inspect.getdoc(function))["Parameters"]
        for name in entry.name.split(", ")
    }
    expected = arguments_of(section)
    others = ("source", "output", "materials", "rest", "name", "progress")
    settings = [n for n in parameters if n not in others]
    assert sorted(settings) == sorted(expected)
    for name, argument in expected.items():
        default = argument.entry.default
        is_plain = not isinstance(default, Section) and default is not MISSING
        assert parameters[name].default == (default if is_plain else None), name
        assert name in documented, name
        if argument.choices:
            hint = get_type_hints(function)[name]
            assert all(choice in str(hint) for choice in argument.choices), name


def test_the_python_call_has_every_setting_with_its_default():
    check_call(tusqh.mesh, Settings)


def test_every_section_survives_the_way_to_plain_values_and_back(repository):
    config = yaml.safe_load((repository / "config/config.yaml").read_text())
    workflow = Workflow.from_dict(config)
    assert Workflow.from_dict(workflow.to_dict()) == workflow
    assert Workflow.from_dict(workflow.to_dict(defaults=False)) == workflow


@pytest.mark.parametrize(
    "block",
    [
        {},
        {"grid": {"cells": [60, 79]}, "samples": 6, "rule": "clamped"},
        {"grid": {"cell_size": 0.25}, "window": {"lower": [-1, -2.5], "upper": [4, 3]}},
        {"target": {"betti_0": 1, "betti_2": {"max": 3}}, "orientation": "as-is"},
        {"volume": "match", "holes": {"keep": 2}, "voids": {"min_volume": 0.5}},
        {"fit": True},
        {"persistence": 0.2, "image": {"empty": -3, "full": 2.5}, "tolerance": 1e-9},
    ],
)
def test_the_command_line_says_every_setting(block):
    """The options read the words that the explorer shows."""
    settings = Settings.from_dict(block)
    read = []
    app = typer.Typer()
    app.command()(with_settings()(take(read)))
    done = CliRunner().invoke(app, to_words(settings))
    assert done.exit_code == 0, done.output
    assert read == [settings]


def take(read):
    """Return a command that keeps its settings in a list."""

    def command(*, settings: Settings) -> None:
        """Keep the settings."""
        read.append(settings)

    return command


def test_options_have_names_of_their_own():
    names = [argument.option for argument in options_of(Settings)]
    assert len(set(names)) == len(names)
    assert len({argument.name for argument in options_of(Settings)}) == len(names)


# The recipe "add an option" of CONTRIBUTING.md: one field, and everything else follows.
@dataclass(frozen=True)
class LargerPolicy(Policy):
    """A policy with one more option."""

    smoothing: int = setting(
        "Number of smoothing steps.", default=2, at_least=0, at_most=9, metavar="N"
    )


@dataclass(frozen=True)
class LargerSettings(Settings):
    """Settings with that policy."""

    policy: LargerPolicy = setting("The policy.", default=LargerPolicy, is_inline=True)


def test_an_option_is_added_in_one_place():
    assert schema_of(LargerSettings)["properties"]["smoothing"] == {
        "description": "Number of smoothing steps.",
        "type": "integer",
        "minimum": 0,
        "maximum": 9,
        "default": 2,
    }
    row = "| `smoothing` | `2` | a whole number of at least 0 and at most 9 | Number of smoothing"
    assert row in to_table(LargerSettings)
    option = next(o for o in options_of(LargerSettings) if o.name == "smoothing")
    assert to_parameter(option).name == "smoothing"
    assert option.option == "--smoothing"
    by_option = from_options(LargerSettings, {"smoothing": "3"})
    assert by_option == from_arguments(LargerSettings, {"smoothing": 3})
    assert by_option == LargerSettings.from_dict({"smoothing": 3})
    assert to_words(by_option) == ["--smoothing", "3"]
    with pytest.raises(AssertionError):  # The signature of `tusqh.mesh` lacks it.
        check_call(tusqh.mesh, LargerSettings)


WAYS = {
    "argument smoothing": lambda: from_arguments(LargerSettings, {"smoothing": 10}),
    "option --smoothing": lambda: from_options(LargerSettings, {"smoothing": "10"}),
    "a.yaml: smoothing": lambda: LargerSettings.from_dict(
        {"smoothing": 10}, locate=lambda path: f"a.yaml: {'.'.join(path)}"
    ),
}


@pytest.mark.parametrize("where", WAYS)
def test_a_mistake_has_the_same_message_in_every_way_to_make_it(where):
    with pytest.raises(tusqh.TusqhError) as caught:
        WAYS[where]()
    assert str(caught.value) == (
        f"{where}: found 10\n"
        "  expected: a whole number of at least 0 and at most 9 (Number of smoothing steps)\n"
        "  remedy:   correct it; config/README.md explains every key"
    )
