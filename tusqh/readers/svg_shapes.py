"""Convert paths and basic shapes of SVG to curves, and flatten them to chains."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np
from svgpathtools import Arc, Line, parse_path

from tusqh.grid import FloatArray
from tusqh.readers.curves import flatten_curve
from tusqh.readers.svg_frame import Viewport, numbers_in
from tusqh.readers.xml_names import tag_of

#: The elements that are shapes.
SHAPES = ("path", "rect", "circle", "ellipse", "line", "polyline", "polygon")


@dataclass(frozen=True)
class Subpath:
    """Continuous curves of one element, and their transform, shape (3, 3)."""

    curves: list[Any]
    transform: FloatArray


def subpaths_of(element: Element, transform: FloatArray, viewport: Viewport) -> list[Subpath]:
    """Return the continuous runs of curves in a shape.

    Parameters
    ----------
    element
        One of `SHAPES`.
    transform
        Transform from its coordinates to those of the root, shape (3, 3).
    viewport
        The reference of percentages.

    Raises
    ------
    ValueError
        A length or the path cannot be read.
    """
    text = _path_of(element, viewport)
    if not text:
        return []
    with warnings.catch_warnings():  # Arcs without a radius are lines and need no warning.
        warnings.simplefilter("ignore")
        return [Subpath(run, transform) for run in _continuous(parse_path(text))]


def _path_of(element: Element, viewport: Viewport) -> str:
    """Return a shape as the text of a path; empty if the shape is not rendered."""
    name = tag_of(element)
    if name == "path":
        text = element.get("d", "")
        return "" if text.strip() == "none" else text
    if name in ("polyline", "polygon"):
        numbers = numbers_in(element.get("points", ""))
        pairs = [f"{x!r} {y!r}" for x, y in zip(numbers[::2], numbers[1::2], strict=False)]
        is_ring = len(pairs) > 1 and (name == "polygon" or pairs[0] == pairs[-1])
        return "M" + "L".join(pairs) + ("z" if is_ring else "") if pairs else ""

    def length(key: str, axis: int) -> float:
        return viewport.length(element.get(key) or "0", axis)

    if name == "line":
        ends = length("x1", 0), length("y1", 1), length("x2", 0), length("y2", 1)
        return "M{!r} {!r}L{!r} {!r}".format(*ends)
    if name in ("circle", "ellipse"):
        cx, cy = length("cx", 0), length("cy", 1)
        rx, ry = (length("r", 2),) * 2 if name == "circle" else _radii(element, viewport)
        if min(rx, ry) <= 0:
            return ""
        half = f"a{rx!r},{ry!r} 0 1,0"
        return f"M{cx - rx!r},{cy!r}{half} {2 * rx!r},0{half} {-2 * rx!r},0z"
    return _rectangle(element, viewport, (length("x", 0), length("y", 1)))


def _radii(element: Element, viewport: Viewport) -> tuple[float, float]:
    """Return rx and ry; a missing radius equals the other one."""
    given = [element.get("rx", "auto"), element.get("ry", "auto")]
    radii = [None if r.strip() == "auto" else viewport.length(r, k) for k, r in enumerate(given)]
    rx, ry = radii
    return float(rx if rx is not None else ry or 0), float(ry if ry is not None else rx or 0)


def _rectangle(element: Element, viewport: Viewport, low: tuple[float, float]) -> str:
    """Return a rectangle, with rounded corners if both radii are positive."""
    w = viewport.length(element.get("width") or "0", 0)
    h = viewport.length(element.get("height") or "0", 1)
    if min(w, h) <= 0:
        return ""
    (x, y), (rx, ry) = low, _radii(element, viewport)
    rx, ry = min(rx, w / 2), min(ry, h / 2)
    x1, y1 = x + w, y + h
    if min(rx, ry) <= 0:
        return f"M{x!r} {y!r}L{x1!r} {y!r}L{x1!r} {y1!r}L{x!r} {y1!r}z"
    arc = f"A{rx!r} {ry!r} 0 0 1"
    return (
        f"M{x + rx!r} {y!r}L{x1 - rx!r} {y!r}{arc} {x1!r} {y + ry!r}L{x1!r} {y1 - ry!r}"
        f"{arc} {x1 - rx!r} {y1!r}L{x + rx!r} {y1!r}{arc} {x!r} {y1 - ry!r}L{x!r} {y + ry!r}"
        f"{arc} {x + rx!r} {y!r}z"
    )


def _continuous(curves: Any) -> Iterator[list[Any]]:
    """Yield the runs of curves in which each curve starts at the end of the previous one."""
    run: list[Any] = []
    for curve in curves:
        if run and run[-1].end != curve.start:
            yield run
            run = []
        run.append(curve)
    if run:
        yield run


def _points_at(curve: Any, transform: FloatArray, parameters: FloatArray) -> FloatArray:
    """Return transformed points on a curve, with exact ends and the y axis pointing up."""
    inner = [curve.point(t) for t in parameters[1:-1]]
    numbers = np.array([curve.start, *inner, curve.end], dtype=np.complex128)
    moved = np.column_stack([numbers.real, numbers.imag]) @ transform[:2, :2].T + transform[:2, 2]
    return np.column_stack([moved[:, 0], 0.0 - moved[:, 1]])


def flatten(subpath: Subpath, tolerance: float) -> FloatArray:
    """Return a polyline within the tolerance of a subpath; shared ends occur once.

    Parameters
    ----------
    subpath
        The subpath.
    tolerance
        Largest distance, in user units of the root.
    """
    parts = []
    for curve in subpath.curves:
        points_at = partial(_points_at, curve, subpath.transform)
        is_arc = isinstance(curve, Arc)
        is_straight = isinstance(curve, Line) or (
            is_arc and 0 in (curve.radius.real, curve.radius.imag)
        )
        ends = np.array([0.0, 1.0])
        parts.append(points_at(ends) if is_straight else flatten_curve(points_at, tolerance))
    return np.concatenate([parts[0][:1], *(part[1:] for part in parts)])
