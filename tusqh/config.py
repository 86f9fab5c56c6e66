"""Reading and validating the workflow's configuration, with messages a user can act on."""

from __future__ import annotations

import copy
import difflib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import jsonschema
import yaml

from tusqh.errors import ConfigError
from tusqh.threshold.goals import find_empty

Mapping = dict[str, Any]

#: Keys of a model that say how its threshold is chosen; at most one is given.
GOALS = ("threshold", "target", "persistence", "volume")


class _UniqueKeyLoader(yaml.SafeLoader):
    """YAML in which a key that stands twice is an error instead of the last one winning."""


def _unique_mapping(loader: _UniqueKeyLoader, node: yaml.MappingNode) -> Mapping:
    seen = set()
    for key_node, _ in node.value:
        if key_node.value in seen:
            raise ConfigError(
                f"the key {key_node.value!r} stands twice, the second time in line "
                f"{key_node.start_mark.line + 1}",
                where=str(loader.name),
                expected="every key, and every model name, once",
                remedy="rename or remove one of the two",
            )
        seen.add(key_node.value)
    loader.flatten_mapping(node)
    return {
        loader.construct_object(key, deep=True): loader.construct_object(value, deep=True)
        for key, value in node.value
    }


_UniqueKeyLoader.add_constructor(yaml.resolver.BaseResolver.DEFAULT_MAPPING_TAG, _unique_mapping)


def read_yaml(path: Path) -> Mapping:
    """Return the mapping in a YAML file.

    Raises
    ------
    ConfigError
        The file is missing, is no YAML mapping, or has a key twice.
    """
    try:
        with path.open(encoding="utf-8") as stream:
            content = yaml.load(stream, Loader=_UniqueKeyLoader)
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as reason:
        raise ConfigError(
            f"cannot be read: {reason}",
            where=str(path),
            expected="a YAML file",
            remedy="correct the place named above",
        ) from reason
    if not isinstance(content, dict):
        raise ConfigError(
            f"holds {_show(content)}",
            where=str(path),
            expected="a mapping with the key `models`",
            remedy="start from config/config.yaml",
        )
    return content


def load_config(paths: Iterable[Path], schema_path: Path, overrides: Mapping) -> Mapping:
    """Return the validated configuration with all defaults filled in.

    Parameters
    ----------
    paths
        Configuration files as given to Snakemake, checked for keys that stand twice.
    schema_path
        The JSON schema, in YAML.
    overrides
        The configuration as Snakemake merged it from the files and its command line.

    Raises
    ------
    ConfigError
        Naming file, key, what was found, what is allowed and the nearest valid key.
    """
    names = [str(path) for path in paths if read_yaml(path) is not None]
    schema = read_yaml(schema_path)
    config = copy.deepcopy(overrides)
    validate(config, schema, where=" + ".join(names) or "--config")
    _require_distinct_names(config["models"], where=" + ".join(names))
    config = dict(_to_declared_types(config, schema, schema["$defs"]))
    _fill_defaults(config, schema)
    for name, model in config["models"].items():
        _fill_defaults(model, schema["$defs"]["model"])
        goals = [goal for goal in GOALS if goal in model]
        if len(goals) > 1:
            raise ConfigError(
                f"the keys {' and '.join(f'`{goal}`' for goal in goals)} are given",
                where=f"{' + '.join(names)}: models.{name}",
                expected="one of them: each says how to choose the threshold",
                remedy="remove the others",
            )
        empty = find_empty(model.get("target", {}))
        if empty:
            raise ConfigError(
                f"found {_show(model['target'][empty])}",
                where=f"{' + '.join(names)}: models.{name}.target.{empty}",
                expected="a range whose min is not above its max",
                remedy="swap the two",
            )
        if not goals:
            model["threshold"] = 0.5
    return config


def validate(config: Mapping, schema: Mapping, *, where: str) -> None:
    """Raise a `ConfigError` for the first thing that the schema does not allow."""
    validator = jsonschema.Draft202012Validator(schema)
    # A misspelt key is also a missing one: name the misspelling.
    errors = sorted(
        validator.iter_errors(config),
        key=lambda e: (e.validator != "additionalProperties", [str(p) for p in e.absolute_path]),
    )
    if not errors:
        return
    error = errors[0]
    if error.context:
        error = max(error.context, key=lambda e: len(e.absolute_path))
    key = ".".join(str(part) for part in error.absolute_path) or "the top level"
    found, expected, remedy = _explain(error)
    raise ConfigError(found, where=f"{where}: {key}", expected=expected, remedy=remedy)


def _explain(error: jsonschema.ValidationError) -> tuple[str, str, str]:
    """Return what was found, what is expected and what to do, for one schema violation."""
    rule: Any = error.validator
    value: Any = error.instance
    schema: Mapping = error.schema if isinstance(error.schema, dict) else {}
    meaning = schema.get("description", "")
    if rule == "additionalProperties":
        allowed = sorted(schema["properties"])
        unknown = sorted(set(value) - set(allowed))[0]
        near = difflib.get_close_matches(unknown, allowed, n=1, cutoff=0.5)
        hint = f"did you mean {near[0]!r}?" if near else "remove it or use one of these"
        return f"unknown key {unknown!r}", "one of " + ", ".join(allowed), hint
    if rule == "required":
        missing = [name for name in schema["required"] if name not in value]
        what = schema.get("properties", {}).get(missing[0], {}).get("description", "")
        return f"the key {missing[0]!r} is missing", what or "that key", "add it"
    if error.parent is None and "propertyNames" in error.absolute_schema_path:
        name = _show(value)
        if rule == "not":
            return f"the model name {name} is reserved", "another name", "rename the model"
        return (
            f"the model name {name} is no plain file name",
            'letters, digits, "_" and "-", starting with a letter or digit',
            "rename the model",
        )
    allowed_text = {
        "enum": lambda: "one of " + ", ".join(map(str, schema["enum"])),
        "type": lambda: f"a value of type {schema['type']}",
        "multipleOf": lambda: f"a multiple of {schema['multipleOf']}",
        "minimum": lambda: f"at least {schema['minimum']}",
        "maximum": lambda: f"at most {schema['maximum']}",
        "exclusiveMinimum": lambda: f"more than {schema['exclusiveMinimum']}",
        "minItems": lambda: f"at least {schema['minItems']} entries",
        "maxItems": lambda: f"at most {schema['maxItems']} entries",
    }
    limit = str(allowed_text.get(str(rule), lambda: error.message)())
    expected = f"{limit} ({meaning.rstrip('.')})" if meaning else limit
    near = difflib.get_close_matches(str(value), [str(v) for v in schema.get("enum", [])], n=1)
    remedy = f"did you mean {near[0]!r}?" if near else "correct it; config/README.md has all keys"
    return f"found {_show(value)}", expected, remedy


def _to_declared_types(value: Any, schema: Mapping, definitions: Mapping) -> Any:
    """Return a value with the number types of its schema: 1 and 1.0 then mean, and record, one."""
    if "$ref" in schema:
        schema = {**definitions[str(schema["$ref"]).rpartition("/")[2]], **schema}
    for alternative in schema.get("anyOf", []):
        value = _to_declared_types(value, alternative, definitions)
    types = schema.get("type", [])
    if isinstance(value, dict):
        known, others = schema.get("properties", {}), schema.get("additionalProperties")
        rules = {key: known.get(key, others if isinstance(others, dict) else {}) for key in value}
        return {key: _to_declared_types(v, rules[key], definitions) for key, v in value.items()}
    if isinstance(value, list):
        rule = schema.get("items", {})
        return [_to_declared_types(item, rule, definitions) for item in value]
    if isinstance(value, bool):
        return value
    if isinstance(value, int) and "number" in types:
        return float(value)
    return int(value) if isinstance(value, float) and "integer" in types else value


def _fill_defaults(values: Mapping, schema: Mapping) -> None:
    """Add the schema's defaults for keys that are absent, level by level."""
    for name, rule in schema.get("properties", {}).items():
        if name not in values and "default" in rule:
            values[name] = copy.deepcopy(rule["default"])
        if isinstance(values.get(name), dict):
            _fill_defaults(values[name], rule)


def _require_distinct_names(models: Mapping, *, where: str) -> None:
    """Raise when two model names differ in case only: one folder on many file systems."""
    seen: dict[str, str] = {}
    for name in models:
        other = seen.setdefault(name.lower(), name)
        if other != name:
            raise ConfigError(
                f"the model names {other!r} and {name!r} differ in upper and lower case only",
                where=f"{where}: models",
                expected="names that stay different on every file system",
                remedy="rename one of them",
            )


def _show(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
