"""Collect the shapes of an SVG drawing, each with its transform, fill rule and clips."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Literal
from xml.etree.ElementTree import Element

import numpy as np

from tusqh.geometry.remark import Remark
from tusqh.grid import FloatArray
from tusqh.readers.svg_frame import Viewport, map_of_viewport, transform_of, viewport_of
from tusqh.readers.svg_shapes import SHAPES, Subpath, subpaths_of
from tusqh.readers.svg_style import references_in, rules_of, style_of
from tusqh.readers.xml_names import tag_of

#: Elements whose content is drawn only if another element refers to it.
_NOT_DRAWN = {"defs", "symbol", "clipPath", "mask", "marker", "pattern", "style", "script"}
_NOT_DRAWN |= {"linearGradient", "radialGradient", "filter", "metadata", "title", "desc"}

#: Elements that draw something but are not read.
_NOT_READ = {"text": "texts", "image": "images", "foreignObject": "foreign objects"}

_XLINK = "{http://www.w3.org/1999/xlink}href"
_DEEPEST = 100


@dataclass(frozen=True)
class Clip:
    """A clip: the function from the chains of the clipped element to the visible shapes."""

    shapes_for: Callable[[list[FloatArray]], list[Shape]]


@dataclass(frozen=True)
class Shape:
    """A drawn element: its subpaths, whether it is filled, its fill rule, and its clips."""

    subpaths: list[Subpath]
    is_filled: bool
    rule: str
    clips: tuple[Clip, ...]


@dataclass(frozen=True)
class _Context:
    """The properties that an element inherits from its ancestors."""

    transform: FloatArray
    style: Mapping[str, str]
    viewport: Viewport
    clips: tuple[Clip, ...] = ()
    depth: int = 0
    replaced: Mapping[str, str] | None = None
    in_clip: bool = False


class Walk:
    """A walk through a drawing.

    Parameters
    ----------
    root
        The root element.

    Raises
    ------
    ValueError
        The root is not an <svg>, or a length or transform cannot be read.
    """

    def __init__(self, root: Element) -> None:
        if tag_of(root) != "svg":
            raise ValueError(f"the root element is <{tag_of(root)}>, not <svg>")
        self._by_id = {e.get("id", ""): e for e in reversed(list(root.iter()))}
        self._rules, n_unknown = rules_of(root)
        self._counts: Counter[tuple[str, str]] = Counter()
        if n_unknown:
            self._counts["left out", "CSS selectors that are not understood"] = n_unknown
        self.shapes: list[Shape] = []
        viewport = viewport_of(root, Viewport())
        style = style_of(root, {}, self._rules)
        context = _Context(transform_of(style, viewport), style, viewport)
        for child in root:
            self._enter(child, context, self.shapes)

    def remarks(self) -> list[Remark]:
        """Return the remarks on the elements that were encountered."""
        order = {"left out": 0, "changed": 1, "noted": 2}
        found = sorted(self._counts.items(), key=lambda item: (order[item[0][0]], item[0][1]))
        return [Remark(effect, what, n) for (effect, what), n in found]  # type: ignore[arg-type]

    def _count(self, effect: Literal["left out", "changed", "noted"], what: str) -> None:
        self._counts[effect, what] += 1

    def _enter(self, element: Element, outer: _Context, shapes: list[Shape]) -> None:
        """Add the shapes of an element and of everything inside it."""
        if not isinstance(element.tag, str) or outer.depth > _DEEPEST:
            return
        name = tag_of(element)
        if name in _NOT_DRAWN and not (name == "symbol" and outer.replaced is not None):
            return
        if name in _NOT_READ:
            self._count("left out", _NOT_READ[name])
            return
        style = style_of(element, outer.style, self._rules)
        if style.get("display") == "none":
            self._count("left out", "elements with `display: none`")
            return
        inner = replace(
            outer,
            style=style,
            transform=outer.transform @ transform_of(style, outer.viewport),
            depth=outer.depth + 1,
            replaced=None,
        )
        inner = replace(inner, clips=outer.clips + self._clips_of(style, inner))
        if name in SHAPES:
            self._add(element, inner, shapes)
        elif name == "use":
            self._use(element, inner, shapes)
        else:
            if name in ("svg", "symbol"):
                inner = self._open_viewport(element, inner, outer.replaced or {})
            children = list(element)[:1] if name == "switch" else element
            for child in children:
                self._enter(child, inner, shapes)

    def _add(self, element: Element, context: _Context, shapes: list[Shape]) -> None:
        """Add a shape."""
        style = context.style
        if style["visibility"] != "visible":
            self._count("left out", "hidden elements")
            return
        given = [element.get(k, "") for k in ("x", "y", "width", "height", "r", "rx", "cx", "cy")]
        if any(value.strip()[-1:].isalpha() for value in given):
            self._count("changed", "elements with units, read as 96 user units to an inch")
        subpaths = subpaths_of(element, context.transform, context.viewport)
        fill = style["fill"].strip().lower()
        is_filled = context.in_clip or fill not in ("none", "transparent")
        if fill.startswith("url(") and not context.in_clip:
            self._count("changed", "elements filled with a gradient or pattern, read as full")
        if fill in ("white", "#fff", "#ffffff") and not context.in_clip:
            self._count("noted", "elements filled with white, which count as material")
        rule = style["clip-rule" if context.in_clip else "fill-rule"]
        if subpaths:
            shapes.append(Shape(subpaths, is_filled, rule, context.clips))

    def _use(self, element: Element, context: _Context, shapes: list[Shape]) -> None:
        """Add the shapes of the element to which a <use> refers, if it exists."""
        name = element.get("href") or element.get(_XLINK) or ""
        target = self._by_id.get(name.removeprefix("#")) if name.startswith("#") else None
        if target is None or context.depth > _DEEPEST // 2:
            self._count("left out", "references (<use>) to what is not in the file")
            return
        shift = np.eye(3)
        for axis, key in enumerate("xy"):
            shift[axis, 2] = context.viewport.length(element.get(key) or "0", axis)
        given = {k: element.get(k, "") for k in ("width", "height") if element.get(k)}
        moved = replace(context, transform=context.transform @ shift, replaced=given)
        self._enter(target, moved, shapes)

    def _open_viewport(
        self, element: Element, context: _Context, replaced: Mapping[str, str]
    ) -> _Context:
        """Return the context inside a nested <svg> or a <symbol>."""
        mapped, corners = map_of_viewport(element, context.viewport, replaced)
        clips = context.clips
        if corners is not None and context.style.get("overflow", "hidden") in ("hidden", "scroll"):
            points = " ".join(f"{x!r},{y!r}" for x, y in corners.tolist())
            box = Element("polygon", {"points": points})
            subpaths = subpaths_of(box, context.transform, context.viewport)
            shape = Shape(subpaths, True, "nonzero", ())
            clips = (*clips, Clip(lambda chains: [shape]))
        viewport = viewport_of(element, context.viewport)
        return replace(
            context, transform=context.transform @ mapped, viewport=viewport, clips=clips
        )

    def _clips_of(self, style: Mapping[str, str], context: _Context) -> tuple[Clip, ...]:
        """Return the clips that a style specifies."""
        if style.get("mask", "none") != "none":
            self._count("noted", "masks, which are not applied")
        value = style.get("clip-path", "none")
        targets = [self._by_id.get(name) for name in references_in(value)]
        if value != "none" and not targets:
            self._count("noted", "clip paths of CSS shapes, which are not applied")
        return tuple(
            Clip(lambda chains, target=target: self._clip_shapes(target, context, chains))  # type: ignore[misc]
            for target in targets
            if target is not None and tag_of(target) == "clipPath"
        )

    def _clip_shapes(
        self, target: Element, context: _Context, chains: list[FloatArray]
    ) -> list[Shape]:
        """Return the shapes of a clip path, in the coordinates of the root."""
        style = style_of(target, context.style, self._rules)
        frame = context.transform @ transform_of(style, context.viewport)
        if target.get("clipPathUnits") == "objectBoundingBox":
            points = np.concatenate(chains) * [1, -1]
            local = (points - frame[:2, 2]) @ np.linalg.inv(frame[:2, :2]).T
            low, size = local.min(axis=0), np.ptp(local, axis=0)
            frame = frame @ np.array([[size[0], 0, low[0]], [0, size[1], low[1]], [0, 0, 1]])
        inner = replace(context, style=style, transform=frame, clips=(), in_clip=True)
        inner = replace(inner, clips=self._clips_of(style, inner))
        shapes: list[Shape] = []
        for child in target:
            self._enter(child, inner, shapes)
        return shapes
