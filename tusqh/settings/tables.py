"""Generate files from the settings: the JSON schema in YAML, and tables in Markdown."""

from __future__ import annotations

import re
from dataclasses import MISSING
from pathlib import Path
from typing import Any

import yaml

from tusqh.errors import ConfigError
from tusqh.settings.features import Feature
from tusqh.settings.field import Entry, entries_of
from tusqh.settings.goal import Range, Target
from tusqh.settings.grid import Grid, Window
from tusqh.settings.materials import Material
from tusqh.settings.model import Model, Study, Workflow
from tusqh.settings.policy import Criteria
from tusqh.settings.schema import schema_of
from tusqh.settings.section import Section
from tusqh.settings.simulation import Simulation
from tusqh.settings.validate import describe_rule, resolved
from tusqh.settings.voxels import Voxels

SCHEMA = Path("workflow/schemas/config.schema.yaml")
GUIDE = Path("config/README.md")

#: Sections that have a table in the guide, by the names of their markers.
_TABLES = {
    kind.__name__: kind
    for kind in (
        Workflow,
        Model,
        Material,
        Grid,
        Window,
        Voxels,
        Target,
        Feature,
        Range,
        Criteria,
        Simulation,
        Study,
    )
}

_HEAD = """\
# Made from the fields in tusqh/settings by `python -m tusqh.settings`: change them, not this file.
"""


def write_all(root: Path) -> list[Path]:
    """Write the files that are generated from the settings.

    Parameters
    ----------
    root
        The checkout.

    Returns
    -------
    changed
        The files whose content changed.
    """
    changed = []
    for path, text in render_all(root).items():
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
            changed.append(path)
    return changed


def render_all(root: Path) -> dict[Path, str]:
    """Return the text of each file that is generated from the settings.

    Parameters
    ----------
    root
        The checkout.
    """
    guide = (root / GUIDE).read_text(encoding="utf-8")
    return {root / SCHEMA: render_schema(Workflow), root / GUIDE: fill_tables(guide)}


def render_schema(section: type[Section]) -> str:
    """Return the JSON schema of a section as YAML.

    Parameters
    ----------
    section
        The section.
    """
    kind: type = section
    schema = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Tusqh workflow configuration",
        **schema_of(kind),
    }
    text = yaml.dump(schema, Dumper=_Plain, sort_keys=False, allow_unicode=True, width=100)
    return _HEAD + str(text)


def fill_tables(guide: str) -> str:
    """Return a guide in Markdown after regenerating the tables between its markers.

    A table lies between ``<!-- settings: NAME -->`` and ``<!-- end -->``.

    Parameters
    ----------
    guide
        The guide.

    Raises
    ------
    ConfigError
        A marker names a section that does not exist.
    """

    def fill(found: re.Match[str]) -> str:
        if found[1] not in _TABLES:
            raise ConfigError(
                f"the marker names {found[1]!r}",
                where=str(GUIDE),
                expected="one of " + ", ".join(_TABLES),
                remedy="correct the marker",
            )
        return f"<!-- settings: {found[1]} -->\n{to_table(_TABLES[found[1]])}<!-- end -->"

    return re.sub(r"<!-- settings: (\w+) -->\n.*?<!-- end -->", fill, guide, flags=re.DOTALL)


def to_table(section: type[Section]) -> str:
    """Return a table in Markdown with a row for each key of a section.

    Parameters
    ----------
    section
        The section.

    Examples
    --------
    >>> print(to_table(Range).splitlines()[2])
    | `min` | any | a whole number of at least 0 | Smallest number. |
    """
    rows = ["| key | default | allowed | meaning |", "|---|---|---|---|"]
    kind: type = section
    schema = schema_of(kind)
    for entry in _keys_of(section):
        rule = _allowed_in_words(schema["properties"][entry.name], schema.get("$defs", {}))
        about = entry.setting
        meaning = about.sentence + (f" Unit: {about.unit}." if about.unit else "")
        cells = (f"`{entry.name}`", _default_in_words(entry), rule, meaning)
        rows.append("| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |")
    return "\n".join(rows) + "\n"


def _keys_of(section: type) -> list[Entry]:
    """Return the fields of a section, including those of its inline sections."""
    entries = []
    for entry in entries_of(section):
        entries += _keys_of(entry.hint) if entry.setting.is_inline else [entry]
    return entries


def _default_in_words(entry: Entry) -> str:
    default: Any = entry.default
    if default is MISSING:
        return "required"
    if isinstance(default, Section):
        return "its keys' defaults"
    default = entry.setting.otherwise if default is None else default
    if default is None:
        return "none"
    if default is entry.setting.otherwise and isinstance(default, str):
        return default
    numbers = default if isinstance(default, tuple) else (default,)
    text = ", ".join(str(number).removesuffix(".0") for number in numbers)
    return f"`[{text}]`" if isinstance(default, tuple) else f"`{text}`"


def _allowed_in_words(schema: dict[str, Any], definitions: dict[str, Any]) -> str:
    if "enum" in schema:
        return ", ".join(f"`{word}`" for word in schema["enum"])
    if "$ref" in schema:
        return "keys " + ", ".join(
            f"`{key}`" for key in resolved(schema, definitions)["properties"]
        )
    return describe_rule(schema, definitions)


class _Plain(yaml.SafeDumper):
    """A YAML dumper without anchors that writes short lists on one line."""

    def ignore_aliases(self, data: Any) -> bool:
        """Return True, so that a value is always written in full."""
        return True


def _represent_list(dumper: _Plain, values: list[Any]) -> yaml.Node:
    is_short = not any(isinstance(value, (dict, list)) for value in values)
    return dumper.represent_sequence("tag:yaml.org,2002:seq", values, flow_style=is_short)


_Plain.add_representer(list, _represent_list)
