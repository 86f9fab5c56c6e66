"""Check plain values against a JSON schema, with messages that a user can act on."""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable
from functools import cache
from typing import TYPE_CHECKING, Any

from tusqh.errors import ConfigError

if TYPE_CHECKING:
    import jsonschema

#: Keys from the top level down to a value.
Path = tuple[str | int, ...]
#: Function that names the source of the value at a path: its file, option or argument.
Locate = Callable[[Path], str]
Mapping = dict[str, Any]

_WORDS = {"string": "text", "boolean": "true or false", "integer": "a whole number"}
_HELP = "correct it; config/README.md explains every key"


def validate(values: Any, schema: Mapping, *, locate: Locate) -> None:
    """Raise a `ConfigError` for the first violation of a schema.

    Parameters
    ----------
    values
        Plain values: mappings, lists, numbers, text.
    schema
        A JSON schema.
    locate
        Function that names the source of the value at a path.

    Raises
    ------
    ConfigError
        A value is invalid; the message names the file or option, the value found, the allowed
        values and the nearest name.
    """
    # Report an unknown key first, because a misspelt key is often also a missing one.
    errors = sorted(
        _validator()(schema).iter_errors(values),
        key=lambda e: (e.validator != "additionalProperties", [str(p) for p in e.absolute_path]),
    )
    if not errors:
        return
    error = errors[0]
    # Among several alternatives, the one that matches the value's kind gives the best message.
    closer = [e for e in error.context or () if e.validator not in ("type", "enum") or e.path]
    closer.sort(key=lambda e: -len(e.absolute_path))
    raise _explain(closer[0] if closer else error, schema.get("$defs", {}), locate)


def refuse(where: str, found: str, expected: str, remedy: str = _HELP) -> ConfigError:
    """Return the error for an invalid setting, regardless of how it was given.

    Parameters
    ----------
    where
        The file and key, the option, or the argument.
    found, expected
        The given value, and the allowed values.
    remedy
        The remedy.
    """
    return ConfigError(found, where=where, expected=expected, remedy=remedy)


def refuse_unknown(where: str, name: str, allowed: list[str], *, kind: str = "key") -> ConfigError:
    """Return the error for an unknown name, with the nearest existing name.

    Parameters
    ----------
    where
        The file and key, the command, or the function.
    name
        The name.
    allowed
        The names that exist.
    kind
        Kind of the name.

    Examples
    --------
    >>> print(refuse_unknown("a.yaml: models.a", "sampels", ["grid", "samples"]))
    a.yaml: models.a: unknown key 'sampels'
      expected: one of grid, samples
      remedy:   did you mean 'samples'?
    """
    near = difflib.get_close_matches(name, allowed, n=1, cutoff=0.5)
    remedy = f"did you mean {near[0]!r}?" if near else "remove it, or use one of these"
    return refuse(where, f"unknown {kind} {name!r}", f"one of {', '.join(sorted(allowed))}", remedy)


@cache
def _validator() -> Any:
    """Return a validator that accepts only finite numbers as numbers."""
    import jsonschema

    def is_number(_: Any, value: Any) -> bool:
        is_real = isinstance(value, (int, float)) and not isinstance(value, bool)
        return is_real and math.isfinite(value)

    draft = jsonschema.Draft202012Validator
    checker = draft.TYPE_CHECKER.redefine("number", is_number)
    return jsonschema.validators.extend(draft, type_checker=checker)  # type: ignore[no-untyped-call]


def _explain(
    error: jsonschema.ValidationError, definitions: Mapping, locate: Locate
) -> ConfigError:
    """Return the error for one violation of a schema."""
    schema: Mapping = error.schema if isinstance(error.schema, dict) else {}
    path: Path = tuple(error.absolute_path)
    value: Any = error.instance
    if error.validator == "additionalProperties":
        allowed = list(schema["properties"])
        unknown = sorted(set(map(str, value)) - set(allowed))[0]
        return refuse_unknown(locate((*path, unknown)), unknown, allowed)
    if error.validator == "required":
        missing = next(name for name in schema["required"] if name not in value)
        about = schema["properties"][missing].get("description", "that key")
        return refuse(locate(path), f"the key {missing!r} is missing", about, "add it")
    if "propertyNames" in error.absolute_schema_path:
        if error.validator == "not":
            found, expected = f"the model name {_show(value)} is reserved", "another name"
        else:
            found = f"the model name {_show(value)} is not a plain file name"
            expected = 'letters, digits, "_" and "-", starting with a letter or digit'
        return refuse(locate((*path, value)), found, expected, "rename the model")
    if error.validator == "not":
        both = schema["not"]["required"]
        where = " and ".join(locate((*path, name)) for name in both)
        return refuse(where, "both are given", "one of the two", "remove one of them")
    if error.validator == "minProperties":
        names = resolved(schema, definitions).get("properties", {})
        expected = f"at least one of {', '.join(names)}" if names else "at least one entry"
        return refuse(locate(path), "nothing is given", expected)
    near = difflib.get_close_matches(str(value), map(str, schema.get("enum", ())), n=1)
    meaning = schema.get("description", "").split(". ")[0].rstrip(".")
    expected = describe_rule(schema, definitions)
    if meaning and "enum" not in schema:
        expected += f" ({meaning})"
    remedy = f"did you mean {near[0]!r}?" if near else _HELP
    return refuse(locate(path), f"found {_show(value)}", expected, remedy)


def describe_rule(schema: Mapping, definitions: Mapping) -> str:
    """Return a description of the values that a schema allows.

    Parameters
    ----------
    schema
        A JSON schema.
    definitions
        Targets of its references, from ``$defs``.

    Examples
    --------
    >>> describe_rule({"type": "number", "exclusiveMinimum": 0, "maximum": 1}, {})
    'a number above 0 and at most 1'
    >>> describe_rule({"type": "array", "minItems": 2, "items": {"type": "integer"}}, {})
    'a list of at least 2 entries, each a whole number'
    """
    schema = resolved(schema, definitions)
    if "anyOf" in schema:
        return ", or ".join(describe_rule(choice, definitions) for choice in schema["anyOf"])
    if "enum" in schema:
        return "one of " + ", ".join(map(str, schema["enum"]))
    kind = schema.get("type", "value")
    if kind == "array":
        return f"a list of {_count(schema)}, each {describe_rule(schema['items'], definitions)}"
    if kind == "object":
        keys = ", ".join(schema.get("properties", {}))
        return f"a mapping with keys of {keys}" if keys else "a mapping"
    limits = {
        "exclusiveMinimum": "above {}",
        "minimum": "of at least {}",
        "maximum": "at most {}",
        "exclusiveMaximum": "below {}",
        "multipleOf": "divisible by {}",
    }
    ranges = [text.format(schema[name]) for name, text in limits.items() if name in schema]
    return " ".join([_WORDS.get(kind, f"a {kind}"), *([" and ".join(ranges)] if ranges else [])])


def _count(schema: Mapping) -> str:
    """Return the allowed number of entries of a list, in words."""
    lowest, highest = schema.get("minItems", 0), schema.get("maxItems")
    entries = "different entries" if schema.get("uniqueItems") else "entries"
    if highest is None:
        return entries if lowest <= 1 else f"at least {lowest} {entries}"
    return f"{lowest} {entries}" if lowest == highest else f"{lowest} to {highest} {entries}"


def to_declared_types(value: Any, schema: Mapping, definitions: Mapping) -> Any:
    """Return a value with the number types of its schema, so that 1 and 1.0 are recorded equally.

    Parameters
    ----------
    value
        A plain value.
    schema
        Its JSON schema.
    definitions
        Targets of references, from ``$defs``.
    """
    return _convert(value, schema, definitions, is_text=False)


def from_text(value: Any, schema: Mapping, definitions: Mapping) -> Any:
    """Return a value after converting text to numbers where its schema requires numbers.

    Text with commas becomes a list if a list is allowed, and any text becomes a list if only a list
    is allowed; text that cannot be converted does not change.

    Parameters
    ----------
    value
        A plain value.
    schema
        Its JSON schema.
    definitions
        Targets of references, from ``$defs``.

    Examples
    --------
    >>> from_text({"a": "2", "b": "2"}, {"properties": {"a": {"type": "number"}}}, {})
    {'a': 2.0, 'b': '2'}
    >>> from_text("3", {"type": "array", "items": {"type": "integer"}}, {})
    [3]
    """
    return _convert(value, schema, definitions, is_text=True)


def _convert(value: Any, schema: Mapping, definitions: Mapping, *, is_text: bool) -> Any:
    schema = resolved(schema, definitions)
    choices = schema.get("anyOf", [schema])
    for choice in (resolved(choice, definitions) for choice in choices):
        kind = choice.get("type")
        if isinstance(value, dict):
            known, others = choice.get("properties", {}), choice.get("additionalProperties")
            rules = {k: known.get(k, others if isinstance(others, dict) else {}) for k in value}
            value = {
                k: _convert(v, rules[k], definitions, is_text=is_text) for k, v in value.items()
            }
        is_list = len(choices) == 1 or (isinstance(value, str) and "," in value)
        if kind == "array" and is_text and isinstance(value, str) and is_list:
            value = [entry.strip() for entry in value.split(",")]
        if isinstance(value, list) and kind == "array":
            items = choice.get("items", {})
            value = [_convert(v, items, definitions, is_text=is_text) for v in value]
        if isinstance(value, str) and is_text:
            value = _number(value, kind)
        if kind == "number" and isinstance(value, int) and not isinstance(value, bool):
            value = float(value)
        if kind == "integer" and isinstance(value, float) and value.is_integer():
            value = int(value)
    return value


def _number(text: str, kind: Any) -> Any:
    if kind == "boolean":
        return {"true": True, "false": False}.get(text.lower(), text)
    for convert in {"integer": (int,), "number": (int, float)}.get(kind, ()):
        try:
            return convert(text)
        except ValueError:
            continue
    return text


def resolved(schema: Mapping, definitions: Mapping) -> Mapping:
    """Return a schema after resolving its reference to a definition.

    Parameters
    ----------
    schema
        A JSON schema.
    definitions
        Targets of references, from ``$defs``.
    """
    if "$ref" not in schema:
        return schema
    return {**definitions[str(schema["$ref"]).rpartition("/")[2]], **schema}


def _show(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
