"""The base class of sections, which converts plain values to a frozen dataclass and back."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from numbers import Integral, Real
from types import NoneType, UnionType
from typing import Any, ClassVar, Self, Union, get_args, get_origin

from tusqh.settings.field import entries_of
from tusqh.settings.schema import schema_of
from tusqh.settings.validate import Locate, Path, refuse, to_declared_types, validate


@dataclasses.dataclass(frozen=True)
class Section:
    """A group of settings.  Subclasses are frozen dataclasses of `setting` fields."""

    #: Heading of the options on the command line.
    title: ClassVar[str] = ""
    #: Fields of which at most one may be given; without any, the first one's `otherwise` applies.
    alternatives: ClassVar[tuple[str, ...]] = ()
    #: Pairs of alternatives that may be given together.
    combinable: ClassVar[tuple[tuple[str, str], ...]] = ()

    def __post_init__(self) -> None:
        """Fill in the first alternative if none is given."""
        if self.alternatives and all(getattr(self, name) is None for name in self.alternatives):
            first = next(e for e in entries_of(type(self)) if e.name == self.alternatives[0])
            object.__setattr__(self, first.name, first.setting.otherwise)

    @classmethod
    def from_dict(cls, values: Mapping[str, Any], *, locate: Locate | None = None) -> Self:
        """Return the checked section that plain values describe.

        Parameters
        ----------
        values
            A value for each key, as in the configuration.  Keys that are omitted, or None, get
            their defaults.
        locate
            Function that names the source of the value at a path of keys, for messages.

        Raises
        ------
        ConfigError
            A key is unknown, a value is out of range, or two values contradict each other.
        """
        locate = locate or (lambda path: ".".join((cls.__name__, *map(str, path))))
        kind: type = cls
        schema = schema_of(kind)
        plain = to_plain(values)
        validate(plain, schema, locate=locate)
        plain = to_declared_types(plain, schema, schema.get("$defs", {}))
        section: Self = _build(cls, plain)
        for path, found, expected in section.find_contradictions():
            raise refuse(locate(path), found, expected, "correct one of them")
        return section

    def to_dict(self, *, defaults: bool = True) -> dict[str, Any]:
        """Return the settings as plain values for YAML and JSON, without those that are None.

        Parameters
        ----------
        defaults
            Whether default values are included.
        """
        plain: dict[str, Any] = {}
        for entry in entries_of(type(self)):
            value = getattr(self, entry.field)
            if value is None or (not defaults and value == entry.default):
                continue
            if isinstance(value, Section):
                inner = value.to_dict(defaults=defaults)
                if not entry.setting.is_inline:
                    inner = {entry.name: inner} if inner else {}
                plain |= inner
            else:
                plain[entry.name] = to_plain(value)
        return plain

    def find_contradictions(self) -> Iterator[tuple[Path, str, str]]:
        """Yield the path, finding and expectation for values that contradict each other."""
        for entry in entries_of(type(self)):
            value = getattr(self, entry.field)
            within: Mapping[Any, Any] = value if isinstance(value, Mapping) else {None: value}
            for key, inner in within.items():
                steps = (None if entry.setting.is_inline else entry.name, key)
                if isinstance(inner, Section):
                    for path, found, expected in inner.find_contradictions():
                        yield (*filter(None, steps), *path), found, expected


def to_plain(value: Any) -> Any:
    """Return a value as dictionaries, lists and Python numbers, without keys that are None.

    Parameters
    ----------
    value
        A section, a mapping, a sequence, an array, a number or text.

    Examples
    --------
    >>> to_plain({"cells": (60, 79), "cell_size": None})
    {'cells': [60, 79]}
    """
    if isinstance(value, Section):
        return value.to_dict()
    if isinstance(value, Mapping):
        return {str(key): to_plain(v) for key, v in value.items() if v is not None}
    if isinstance(value, Sequence) and not isinstance(value, (str, bytes)):
        return [to_plain(inner) for inner in value]
    if hasattr(value, "tolist"):  # Arrays and numbers of NumPy.
        return value.tolist()
    if isinstance(value, bool):
        return value
    if isinstance(value, Integral):
        return int(value)
    return float(value) if isinstance(value, Real) else value


def _build(hint: Any, value: Any) -> Any:
    """Convert a valid plain value to the type of its field."""
    if get_origin(hint) in (Union, UnionType):
        return _build(_alternative(hint, value), value)
    if get_origin(hint) is tuple:
        return tuple(_build(get_args(hint)[0], inner) for inner in value)
    if get_origin(hint) is Mapping:
        return {key: _build(get_args(hint)[1], inner) for key, inner in value.items()}
    if not isinstance(hint, type) or not issubclass(hint, Section):
        return value
    given = {}
    for entry in entries_of(hint):
        if entry.setting.is_inline:
            given[entry.field] = _build(entry.hint, value)
        elif entry.name in value:
            given[entry.field] = _build(entry.hint, value[entry.name])
    return hint(**given)


def _alternative(hint: Any, value: Any) -> Any:
    """Return the member of a union that matches a valid value."""
    for choice in get_args(hint):
        kind = get_origin(choice) or choice
        is_section = dataclasses.is_dataclass(choice)
        if (
            (kind is tuple and isinstance(value, list))
            or (is_section and isinstance(value, dict))
            or (kind is NoneType and value is None)
        ):
            return choice
    return next(c for c in get_args(hint) if c is not NoneType and get_origin(c) is not tuple)
