"""Fields of the settings: dataclass fields with a description, a range and a unit."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any, get_type_hints

#: Names of limits, as keywords of `setting` and of JSON schema.
_LIMITS = {
    "above": "exclusiveMinimum",
    "below": "exclusiveMaximum",
    "at_least": "minimum",
    "at_most": "maximum",
    "multiple_of": "multipleOf",
}


@dataclasses.dataclass(frozen=True)
class Setting:
    """Properties of a field other than its name, type and default.

    Parameters
    ----------
    sentence
        What the setting means, in one or two sentences.
    unit
        Unit of its value; empty for dimensionless values and words.
    otherwise
        What applies if the default is None: a value, or words for the documentation.
    limits
        Range of its numbers, as keywords of JSON schema.
    n_items
        Smallest and largest number of entries of a list; None for no limit.
    is_distinct
        Whether the entries of a list must differ.
    extra
        Further keywords of JSON schema.
    is_inline
        Whether the keys of this section are on the level of its neighbours, not below its own key.
    is_spread
        Whether the fields of this section are separate arguments of `tusqh.mesh`.
    argument
        Name of the option and argument for a whole section, such as ``betti``.
    prefix
        Prefix of this section's options on the command line.
    metavar
        Placeholder for the value in the help of the command line.
    kinds
        Kinds of geometry ("outline", "surface", "image", "picture") for which it has an effect;
        empty: all.
    needs
        Values of neighbours without which it has no effect.
    needs_one_of
        Neighbours without any of which it has no effect.
    key
        Its key in the configuration, if the name of the field cannot be one; empty: that name.
    option
        Its option on the command line, without dashes; empty: its name, after the value where only
        one is possible.
    words
        Options of the command line, each of which may be given several times and adds an entry to
        a list; empty: one option.
    """

    sentence: str
    unit: str = ""
    otherwise: Any = None
    limits: Mapping[str, float] = dataclasses.field(default_factory=dict)
    n_items: tuple[int, int | None] = (1, None)
    is_distinct: bool = False
    extra: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    is_inline: bool = False
    is_spread: bool = False
    argument: str = ""
    prefix: str = ""
    metavar: str = ""
    kinds: tuple[str, ...] = ()
    needs: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    needs_one_of: tuple[str, ...] = ()
    key: str = ""
    option: str = ""
    words: tuple[str, ...] = ()


@dataclasses.dataclass(frozen=True)
class Entry:
    """A field of a section, from which a schema, a table row or an option can be made.

    Parameters
    ----------
    name
        Name of the key.
    hint
        Type of the field.
    default
        Default; `dataclasses.MISSING` if the setting is required.
    setting
        Further properties.
    field
        Name of the field.
    """

    name: str
    hint: Any
    default: Any
    setting: Setting
    field: str


#: The fields of the sections that were asked for (mypy refuses dataclasses in `functools.cache`).
_ENTRIES: dict[type, tuple[Entry, ...]] = {}


def setting(sentence: str, *, default: Any = dataclasses.MISSING, **about: Any) -> Any:
    """Return a dataclass field for a setting.

    Parameters
    ----------
    sentence
        Meaning of the setting.
    default
        The default; a class stands for its instance.  Without a default the setting is required.
    **about
        `above`, `below`, `at_least`, `at_most` and `multiple_of` limit numbers; the others are
        parameters of `Setting`.

    Examples
    --------
    >>> field = setting("Number of trials.", default=3, at_least=1)
    >>> field.default, field.metadata["setting"].limits
    (3, {'minimum': 1})
    """
    limits = {_LIMITS[name]: about.pop(name) for name in _LIMITS if name in about}
    metadata = {"setting": Setting(sentence, limits=limits, **about)}
    if isinstance(default, type):
        return dataclasses.field(default_factory=default, metadata=metadata)
    return dataclasses.field(default=default, metadata=metadata)


def entries_of(section: type) -> tuple[Entry, ...]:
    """Return the fields of a section in their order.

    Parameters
    ----------
    section
        The section.

    Returns
    -------
    entries
        One entry for each field.
    """
    if section in _ENTRIES:
        return _ENTRIES[section]
    hints = get_type_hints(section)
    entries = []
    for field in dataclasses.fields(section):
        default = field.default
        if field.default_factory is not dataclasses.MISSING:
            default = field.default_factory()
        about = field.metadata["setting"]
        name = about.key or field.name
        entries.append(Entry(name, hints[field.name], default, about, field.name))
    return _ENTRIES.setdefault(section, tuple(entries))
