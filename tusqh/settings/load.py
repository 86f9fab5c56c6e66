"""Read the configuration of the workflow from YAML files and Snakemake's command line."""

from __future__ import annotations

import copy
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import yaml

from tusqh.errors import ConfigError
from tusqh.settings.model import Workflow
from tusqh.settings.schema import schema_of
from tusqh.settings.validate import Locate, from_text, refuse, refuse_unknown
from tusqh.settings.validate import Path as Keys

#: Name, in messages, of Snakemake's option for single values.
COMMAND_LINE = "--config"

_MISSING = object()


class _UniqueKeyLoader(yaml.SafeLoader):
    """YAML loader that rejects duplicate keys (PyYAML keeps the last one silently)."""


def _unique_mapping(loader: _UniqueKeyLoader, node: yaml.MappingNode) -> dict[Any, Any]:
    seen = set()
    for key_node, _ in node.value:
        if key_node.value in seen:
            raise refuse(
                str(loader.name),
                f"duplicate key {key_node.value!r} (second occurrence in line "
                f"{key_node.start_mark.line + 1})",
                "every key, and every model name, once",
                "rename or remove one of the two",
            )
        seen.add(key_node.value)
    loader.flatten_mapping(node)
    return {
        loader.construct_object(key, deep=True): loader.construct_object(value, deep=True)
        for key, value in node.value
    }


_UniqueKeyLoader.add_constructor(yaml.resolver.BaseResolver.DEFAULT_MAPPING_TAG, _unique_mapping)


def read_yaml(path: Path) -> dict[str, Any]:
    """Return the mapping in a YAML file.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    ConfigError
        The file is missing, is not a YAML mapping, or has a duplicate key.
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
            f"contains {content!r:.60}",
            where=str(path),
            expected="a mapping with the key `models`",
            remedy="start from config/config.yaml",
        )
    return content


def load_config(
    paths: Iterable[Path], merged: Mapping[str, Any], *, given: Mapping[str, Any] | None = None
) -> Workflow:
    """Return the checked configuration of the workflow.

    Parameters
    ----------
    paths
        The configuration files that Snakemake merged.
    merged
        The configuration that Snakemake merged from the files and its command line.
    given
        The part from the option ``--config``, in which numbers are text.

    Raises
    ------
    ConfigError
        The configuration is invalid; the message names the file or ``--config``, the key, the value
        found, the allowed values and the nearest key.
    """
    schema = schema_of(Workflow)
    files = {_show(path): read_yaml(path) for path in paths}
    typed = from_text(_to_dict(given or {}), schema, schema.get("$defs", {}))
    config = _overlay(copy.deepcopy(_to_dict(merged)), typed)
    locate = _locate_in(config, {COMMAND_LINE: typed, **files})
    _require_values(config, locate)
    workflow = Workflow.from_dict(config, locate=locate)
    _require_distinct_names(workflow.models, locate)
    for name in workflow.study.peers or ():
        if name not in workflow.models:
            models = list(workflow.models)
            raise refuse_unknown(locate(("study", "peers")), name, models, kind="model")
    return workflow


def _locate_in(config: Mapping[str, Any], sources: Mapping[str, Any]) -> Locate:
    """Return a function that names the source of the value at a path of keys."""

    def locate(keys: Keys) -> str:
        value = _value_at(config, keys)
        same = [name for name, content in sources.items() if _value_at(content, keys) == value]
        named = [name for name, content in sources.items() if _value_at(content, keys) != _MISSING]
        file = (same or named or [" + ".join(n for n in sources if n != COMMAND_LINE)])[0]
        file = f"from {file}" if file == COMMAND_LINE else file
        return ": ".join(filter(None, [file, ".".join(map(str, keys))]))

    return locate


def _value_at(content: Any, keys: Keys) -> Any:
    for key in keys:
        try:
            content = content[key]
        except (KeyError, IndexError, TypeError):
            return _MISSING
    return content


def _to_dict(value: Any) -> Any:
    """Convert mappings of any kind to dictionaries with text keys."""
    if isinstance(value, Mapping):
        return {str(key): _to_dict(inner) for key, inner in value.items()}
    return [_to_dict(inner) for inner in value] if isinstance(value, (list, tuple)) else value


def _overlay(below: dict[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    """Override one configuration by another, key by key."""
    for key, value in above.items():
        if isinstance(value, Mapping) and isinstance(below.get(key), dict):
            _overlay(below[key], value)
        else:
            below[key] = value
    return below


def _require_values(content: Any, locate: Locate, keys: Keys = ()) -> None:
    """Raise an error for a key without a value."""
    if content is None:
        raise refuse(locate(keys), "no value is given", "a value", "add one, or remove the key")
    entries: Any = ()
    if isinstance(content, dict):
        entries = content.items()
    elif isinstance(content, list):
        entries = enumerate(content)
    for key, value in entries:
        _require_values(value, locate, (*keys, key))


def _require_distinct_names(models: Mapping[str, Any], locate: Locate) -> None:
    """Raise an error if model names differ only in case, which many file systems ignore."""
    seen: dict[str, str] = {}
    for name in models:
        other = seen.setdefault(name.lower(), name)
        if other != name:
            raise refuse(
                locate(("models", name)),
                f"the model names {other!r} and {name!r} differ in upper and lower case only",
                "names that stay different on every file system",
                "rename one of them",
            )


def _show(path: Path) -> str:
    """Return a path, relative to the working folder if it is inside that folder."""
    folder = Path.cwd()
    return str(path.relative_to(folder) if path.is_relative_to(folder) else path)
