"""Lengths, transforms and viewports of SVG."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from xml.etree.ElementTree import Element

import numpy as np

from tusqh.grid import FloatArray

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_UNITS = {"": 1.0, "px": 1.0, "in": 96.0, "cm": 96 / 2.54, "mm": 96 / 25.4, "q": 96 / 101.6}
_UNITS |= {"pt": 96 / 72, "pc": 16.0, "em": 16.0, "rem": 16.0, "ex": 8.0}
#: Real lengths: how many of the second unit one of the first is.
_REAL = {"mm": (1.0, "mm"), "cm": (1.0, "cm"), "in": (1.0, "in"), "q": (0.25, "mm")}
_REAL |= {"pt": (1 / 72, "in"), "pc": (1 / 6, "in")}
_ANGLES = {"": 1.0, "deg": 1.0, "rad": 180 / math.pi, "grad": 0.9, "turn": 360.0}
_KEYWORDS = {"left": 0.0, "top": 0.0, "center": 0.5, "right": 1.0, "bottom": 1.0}


@dataclass(frozen=True)
class Viewport:
    """The box to which percentages refer, in user units; `size` is None if it is unknown."""

    low: tuple[float, float] = (0.0, 0.0)
    size: tuple[float, float] | None = None

    def length(self, text: str, axis: int) -> float:
        """Return a length in user units (96 to an inch).

        Parameters
        ----------
        text
            A number with or without a unit.
        axis
            Reference of a percentage: 0 for widths, 1 for heights, 2 for radii.

        Raises
        ------
        ValueError
            The text is not a length, or is a percentage of an unknown size.
        """
        match = re.fullmatch(rf"\s*({_NUMBER})\s*([a-zA-Z]*|%)\s*", text)
        if match is None or match[2].lower() not in {*_UNITS, "%"}:
            raise ValueError(f"the length {text[:40]!r} is not a number with a unit of SVG")
        number, unit = float(match[1]), match[2].lower()
        if unit != "%":
            return number * _UNITS[unit]
        if self.size is None:
            raise ValueError(f"the length {text!r} is a part of a drawing without width or viewBox")
        return number / 100 * (*self.size, math.hypot(*self.size) / math.sqrt(2))[axis]


def numbers_in(text: str) -> list[float]:
    """Return the numbers in a text.

    Parameters
    ----------
    text
        Numbers separated by spaces or commas.
    """
    return [float(number) for number in re.findall(_NUMBER, text)]


def viewport_of(element: Element, outer: Viewport) -> Viewport:
    """Return the viewport to which percentages inside an <svg> or <symbol> refer.

    Parameters
    ----------
    element
        The element.
    outer
        The viewport that it is in.
    """
    box = numbers_in(element.get("viewBox", ""))
    if len(box) == 4:
        return Viewport((box[0], box[1]), (box[2], box[3]))
    width, height = element.get("width"), element.get("height")
    if outer.size is None and any(v is None or v.strip().endswith("%") for v in (width, height)):
        return Viewport()
    size = outer.length(width or "100%", 0), outer.length(height or "100%", 1)
    return Viewport((0.0, 0.0), size)


def unit_of_root(element: Element) -> tuple[float, str]:
    """Return the length of a user unit of the root element, and the unit of that length.

    Parameters
    ----------
    element
        The root.

    Returns
    -------
    size, unit
        The length in millimetres, centimetres or inches; 1 and an empty unit if `width` and
        `height` are pixels, percentages or missing.
    """
    box, sizes, unit = numbers_in(element.get("viewBox", "")), [], ""
    for axis, key in enumerate(("width", "height")):
        match = re.fullmatch(rf"\s*({_NUMBER})\s*([a-zA-Z]+)\s*", element.get(key, ""))
        if match is None or match[2].lower() not in _REAL or float(match[1]) <= 0:
            continue
        per_real, real = _REAL[match[2].lower()]
        unit = unit or real
        if real != unit:  # The other side has the same length in another unit.
            continue
        if len(box) != 4:
            sizes.append(1 / _UNITS[unit])  # A user unit is a pixel.
        elif box[2 + axis] > 0:
            sizes.append(float(match[1]) * per_real / box[2 + axis])
    if not sizes:
        return 1.0, ""
    is_slice = "slice" in element.get("preserveAspectRatio", "")
    return (max(sizes) if is_slice else min(sizes)), unit


def map_of_viewport(
    element: Element, outer: Viewport, replaced: Mapping[str, str]
) -> tuple[FloatArray, FloatArray | None]:
    """Return the transform of a nested <svg> or <symbol>, and the corners of its clip.

    Parameters
    ----------
    element
        The element.
    outer
        The viewport that contains it.
    replaced
        `width` and `height` of a <use> that replace those of the element.

    Returns
    -------
    transform, corners
        The transform from inner coordinates, shape (3, 3), and the corners of the viewport in outer
        coordinates, shape (4, 2), or None if its size is unknown.
    """
    given = {**element.attrib, **replaced}
    x, y = outer.length(given.get("x", "0"), 0), outer.length(given.get("y", "0"), 1)
    box = numbers_in(given.get("viewBox", ""))
    shift = np.array([[1.0, 0, x], [0, 1, y], [0, 0, 1]])
    if outer.size is None and ("width" not in given or "height" not in given):
        return shift, None
    w = outer.length(given.get("width", "100%"), 0)
    h = outer.length(given.get("height", "100%"), 1)
    corners = np.array([[x, y], [x + w, y], [x + w, y + h], [x, y + h]])
    if len(box) != 4 or min(box[2:]) <= 0:
        return shift, corners
    sx, sy = w / box[2], h / box[3]
    aspect = given.get("preserveAspectRatio", "xMidYMid meet")
    part = np.zeros(2)
    if "none" not in aspect:
        sx = sy = max(sx, sy) if "slice" in aspect else min(sx, sy)
        for axis, letter in enumerate("xY"):
            found = re.search(rf"{letter}(Min|Mid|Max)", aspect)
            part[axis] = {"Min": 0.0, "Mid": 0.5, "Max": 1.0}[found[1] if found else "Mid"]
    free = np.array([w - sx * box[2], h - sy * box[3]]) * part
    dx, dy = x + free[0] - sx * box[0], y + free[1] - sy * box[1]
    return np.array([[sx, 0, dx], [0, sy, dy], [0, 0, 1.0]]), corners


def transform_of(style: Mapping[str, str], viewport: Viewport) -> FloatArray:
    """Return the transform of a style, about its origin, shape (3, 3).

    Parameters
    ----------
    style
        Style with `transform` and `transform-origin`, from attributes or CSS.
    viewport
        The reference of percentages.

    Raises
    ------
    ValueError
        The transform cannot be read.
    """
    text = style.get("transform", "none")
    matrix = np.eye(3)
    if text.strip() in ("", "none"):
        return matrix
    pattern = r"([a-zA-Z]+)\s*\(([^()]*)\)"
    if re.sub(pattern, "", text).strip(" ,\t\r\n"):
        raise ValueError(f"the transform {text[:60]!r} cannot be read")
    for name, arguments in re.findall(pattern, text):
        matrix = matrix @ _function(name, re.split(r"[\s,]+", arguments.strip()), text, viewport)
    words = style.get("transform-origin", "").split()
    if words:
        x, y = _origin(words if len(words) > 1 else [*words, "center"], viewport)
        to, back = np.eye(3), np.eye(3)
        to[:2, 2], back[:2, 2] = (x, y), (-x, -y)
        matrix = to @ matrix @ back
    return matrix


def _origin(words: list[str], viewport: Viewport) -> list[float]:
    """Return the origin of a transform."""
    if words[0] in ("top", "bottom") or words[1] in ("left", "right"):
        words = [words[1], words[0]]
    if any(w in _KEYWORDS for w in words[:2]) and viewport.size is None:
        raise ValueError("a transform-origin is a part of a drawing without width or viewBox")
    size = viewport.size or (0.0, 0.0)
    point = []
    for axis, word in enumerate(words[:2]):
        if word in _KEYWORDS:
            point.append(viewport.low[axis] + _KEYWORDS[word] * size[axis])
        else:
            is_part = word.endswith("%")
            point.append(viewport.length(word, axis) + (viewport.low[axis] if is_part else 0.0))
    return point


def _function(name: str, arguments: list[str], text: str, viewport: Viewport) -> FloatArray:
    """Return the matrix of one function of a transform."""
    try:
        if name.startswith("translate"):
            axes = {"translateX": [0], "translateY": [1], "translate": [0, 1]}[name]
            shift = np.eye(3)
            for axis, argument in zip(axes, arguments, strict=False):
                shift[axis, 2] = viewport.length(argument, axis)
            return shift
        if name == "matrix":
            a, b, c, d, e, f = map(float, arguments)
            return np.array([[a, c, e], [b, d, f], [0, 0, 1]])
        if name.startswith("scale"):
            first, last = float(arguments[0]), float(arguments[-1])
            x, y = {"scale": (first, last), "scaleX": (first, 1), "scaleY": (1, first)}[name]
            return np.diag([x, y, 1.0])
        angles = [_angle(argument) for argument in arguments[:1]]
        if name == "rotate":
            about = [viewport.length(argument, 0) for argument in arguments[1:]] or [0.0, 0.0]
            cos, sin = math.cos(angles[0]), math.sin(angles[0])
            turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0, 0, 1]])
            turn[:2, 2] = about - turn[:2, :2] @ about
            return turn
        skew = np.eye(3)
        skew[{"skewX": (0, 1), "skewY": (1, 0)}[name]] = math.tan(angles[0])
        return skew
    except (KeyError, ValueError, IndexError) as error:
        raise ValueError(f"the transform {text[:60]!r} cannot be read") from error


def _angle(text: str) -> float:
    """Return an angle in radians."""
    match = re.fullmatch(rf"({_NUMBER})([a-z]*)", text)
    if match is None or match[2] not in _ANGLES:
        raise ValueError(text)
    return math.radians(float(match[1]) * _ANGLES[match[2]])
