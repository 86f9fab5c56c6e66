"""Make the JSON schema of a section from its fields."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from functools import cache
from itertools import combinations
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin

from tusqh.settings.field import Entry, Setting, entries_of

Schema = dict[str, Any]

_KINDS = {int: "integer", float: "number", str: "string", bool: "boolean"}


@cache
def schema_of(section: type) -> Schema:
    """Return the JSON schema of a section; the sections within it are in ``$defs``.

    Parameters
    ----------
    section
        The section.

    Examples
    --------
    >>> from tusqh.settings.policy import Criteria
    >>> schema_of(Criteria)["properties"]["min_cells"]["minimum"]
    1
    """
    definitions: dict[str, Schema] = {}
    schema = _object(section, definitions)
    return {**schema, "$defs": definitions} if definitions else schema


def inner_type(hint: Any) -> Any:
    """Return a type without None.

    Parameters
    ----------
    hint
        The type.

    Examples
    --------
    >>> inner_type(int | None)
    <class 'int'>
    """
    if get_origin(hint) in (Union, UnionType):
        choices = [choice for choice in get_args(hint) if choice is not NoneType]
        return choices[0] if len(choices) == 1 else Union[tuple(choices)]  # noqa: UP007
    return hint


def _object(section: type, definitions: dict[str, Schema]) -> Schema:
    properties: dict[str, Schema] = {}
    required: list[str] = []
    rules = _rules(getattr(section, "alternatives", ()), getattr(section, "combinable", ()))
    for entry in entries_of(section):
        if entry.setting.is_inline:
            inner = _object(entry.hint, definitions)
            properties |= inner["properties"]
            required += inner.get("required", [])
            rules += inner.get("allOf", [])
        else:
            properties[entry.name] = _property(entry, definitions)
            if entry.default is dataclasses.MISSING:
                required.append(entry.name)
    schema: Schema = {"type": "object", "additionalProperties": False}
    if required:
        schema["required"] = required
    if rules:
        schema["allOf"] = rules
    return {**schema, "properties": properties}


def _rules(alternatives: tuple[str, ...], combinable: tuple[tuple[str, str], ...]) -> list[Schema]:
    """Return rules that reject pairs of these keys unless they can be combined."""
    refused = (pair for pair in combinations(alternatives, 2) if pair not in combinable)
    return [{"not": {"required": list(pair)}} for pair in refused]


def _property(entry: Entry, definitions: dict[str, Schema]) -> Schema:
    about = entry.setting
    unit = f" Unit: {about.unit}." if about.unit else ""
    schema: Schema = {"description": about.sentence + unit}
    schema |= _typed(entry.hint, about, definitions) | dict(about.extra)
    default = entry.default
    if default is None and not isinstance(about.otherwise, str):
        default = about.otherwise
    if dataclasses.is_dataclass(default) and not isinstance(default, type):
        default = default.to_dict()  # type: ignore[attr-defined]
    if default is not None and default is not dataclasses.MISSING:
        schema["default"] = list(default) if isinstance(default, tuple) else default
    return schema


def _typed(hint: Any, about: Setting, definitions: dict[str, Schema]) -> Schema:
    """Return the part of a schema that follows from a type and the limits of its numbers."""
    hint = inner_type(hint)
    origin, arguments = get_origin(hint), get_args(hint)
    if origin is Literal:
        return {"enum": list(arguments)}
    if origin in (Union, UnionType):
        return {"anyOf": [_typed(choice, about, definitions) for choice in arguments]}
    if origin is tuple:
        lowest, highest = about.n_items
        schema: Schema = {"type": "array", "items": _typed(arguments[0], about, definitions)}
        schema["minItems"] = lowest
        if highest is not None:
            schema["maxItems"] = highest
        return schema | ({"uniqueItems": True} if about.is_distinct else {})
    if origin is Mapping:
        return {
            "type": "object",
            "additionalProperties": _typed(arguments[1], about, definitions),
        }
    if dataclasses.is_dataclass(hint):
        name = hint.__name__  # type: ignore[union-attr]
        if name not in definitions:
            definitions[name] = {}
            definitions[name] = _object(hint, definitions)  # type: ignore[arg-type]
        return {"$ref": f"#/$defs/{name}"}
    kind = _KINDS[hint]
    return {"type": kind} | (dict(about.limits) if kind in ("integer", "number") else {})
