"""Find settings without an effect, from the kinds and needs that their fields state."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from tusqh.settings.field import entries_of
from tusqh.settings.section import Section

#: The plural of each kind of geometry.
_PLURALS = {
    "outline": "outlines",
    "surface": "surfaces",
    "image": "images",
    "picture": "pictures",
}


def find_without_effect(settings: Section, kind: str) -> Iterator[str]:
    """Yield a sentence for each non-default setting that has no effect.

    Parameters
    ----------
    settings
        The settings of a mesh or of a model.
    kind
        The kind of geometry: "outline", "surface", "image" or "picture".

    Examples
    --------
    >>> from tusqh.settings.model import Settings
    >>> settings = Settings.from_dict({"voids": {"min_cells": 2}})
    >>> list(find_without_effect(settings, "outline"))
    ['`voids.min_cells` applies only to surfaces and images']
    >>> list(find_without_effect(settings, "surface"))
    []
    """
    return _find(settings, kind, prefix="", kinds=())


def _find(settings: Section, kind: str, *, prefix: str, kinds: tuple[str, ...]) -> Iterator[str]:
    """Yield the settings without an effect in a section that applies to the given kinds."""
    for entry in entries_of(type(settings)):
        about, value = entry.setting, getattr(settings, entry.field)
        name, applies_to = prefix + entry.name, about.kinds or kinds
        needed = {key: wish for key, wish in about.needs.items() if _value(settings, key) != wish}
        if isinstance(value, Section):
            inner = prefix if about.is_inline else f"{name}."
            yield from _find(value, kind, prefix=inner, kinds=applies_to)
        elif value == entry.default:
            continue
        elif applies_to and kind not in applies_to:
            yield f"`{name}` applies only to {' and '.join(_PLURALS[k] for k in applies_to)}"
        elif needed:
            needs = " and ".join(f"`{key}: {wish}`" for key, wish in needed.items())
            yield f"`{name}` applies only with {needs}"
        elif about.needs_one_of and all(getattr(settings, k) is None for k in about.needs_one_of):
            yield f"`{name}` applies only with {' or '.join(f'`{k}`' for k in about.needs_one_of)}"


def _value(settings: Section, name: str) -> Any:
    """Return the value that applies for a setting, also if it is not given."""
    entry = next(entry for entry in entries_of(type(settings)) if entry.name == name)
    value = getattr(settings, name)
    return entry.setting.otherwise if value is None else value
