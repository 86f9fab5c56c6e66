"""Compute styles of SVG elements from attributes, `style` attributes, CSS rules and inheritance."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from xml.etree.ElementTree import Element

from tusqh.readers.xml_names import tag_of

#: Properties that an element passes on to its children, with their initial values.
INHERITED = {"fill": "black", "fill-rule": "nonzero", "clip-rule": "nonzero"}
INHERITED |= {"visibility": "visible"}

_OTHERS = ("display", "clip-path", "mask", "transform", "transform-origin", "overflow")
_SELECTOR = re.compile(r"([\w-]+|\*)?((?:[.#][\w-]+)*)")

#: A selector (tag, and names with their mark) and its declarations.
Rule = tuple[str, tuple[str, ...], dict[str, str]]


def rules_of(root: Element) -> tuple[list[Rule], int]:
    """Return the CSS rules in a drawing, and the number of selectors that were not understood.

    Parameters
    ----------
    root
        The root element.

    Returns
    -------
    rules, n_unknown
        The rules in order of increasing specificity, and the number of unknown selectors.
    """
    rules: list[Rule] = []
    n_unknown = 0
    for element in root.iter():
        if not isinstance(element.tag, str) or tag_of(element) != "style":
            continue
        text = re.sub(
            r"/\*.*?\*/|<!--|-->|@(?:import|charset)[^;]*;", "", element.text or "", flags=re.S
        )
        for selectors, body in re.findall(r"([^{}]+)\{([^{}]*)\}", text):
            for selector in selectors.split(","):
                match = _SELECTOR.fullmatch(selector.strip())
                if match is None:
                    n_unknown += not selector.strip().startswith("@")
                    continue
                names = tuple(re.findall(r"[.#][\w-]+", match[2]))
                rules.append((match[1] or "*", names, _declarations(body)))
    rules.sort(key=lambda rule: (sum(n[0] == "#" for n in rule[1]), len(rule[1]), rule[0] != "*"))
    return rules, n_unknown


def _declarations(text: str) -> dict[str, str]:
    """Return the properties in a list of CSS declarations."""
    pairs = (part.partition(":") for part in text.split(";") if ":" in part)
    return {
        name.strip().lower(): re.sub(r"!\s*important", "", value).strip()
        for name, _, value in pairs
    }


def style_of(element: Element, outer: Mapping[str, str], rules: list[Rule]) -> dict[str, str]:
    """Return the style of an element.

    Parameters
    ----------
    element
        The element.
    outer
        The style of its parent.
    rules
        CSS rules, in order of increasing specificity.
    """
    style = {name: outer.get(name, value) for name, value in INHERITED.items()}
    own = {n: element.get(n, "") for n in (*INHERITED, *_OTHERS) if element.get(n) is not None}
    names = {f"#{element.get('id')}", *(f".{name}" for name in element.get("class", "").split())}
    for tag, wanted, declared in rules:
        if tag in ("*", tag_of(element)) and names.issuperset(wanted):
            own.update(declared)
    own.update(_declarations(element.get("style", "")))
    style.update((name, value) for name, value in own.items() if value != "inherit")
    return style


def references_in(value: str) -> Iterator[str]:
    """Yield the names in ``url(#name)`` of a property.

    Parameters
    ----------
    value
        The value of the property.
    """
    yield from re.findall(r"url\(\s*['\"]?#([^)'\"]+)['\"]?\s*\)", value)
