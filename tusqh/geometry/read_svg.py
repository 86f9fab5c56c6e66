"""Read the chains of an SVG drawing: paths and basic shapes, transforms applied."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from svgpathtools import Line, parse_path
from svgpathtools.document import CONVERSIONS
from svgpathtools.parser import parse_transform

from tusqh.grid import FloatArray

#: Largest distance of a curve from its polyline, relative to the larger side of the drawing:
#: a hundredth of a cell in a grid of a hundred cells, so no volume fraction notices.
CHORD_TOLERANCE = 1e-4

#: No curve is cut finer than this, whatever the tolerance.
MOST_CHORDS = 4096

#: Elements whose content is drawn only when something else refers to it.
_NOT_DRAWN = {"defs", "symbol", "clipPath", "mask", "marker", "pattern"}

_XLINK = "{http://www.w3.org/1999/xlink}href"


@dataclass(frozen=True)
class _Subpath:
    """Continuous curves of one element and the transform, shape (3, 3), that applies to them."""

    curves: list[Any]
    transform: FloatArray


def read_svg_chains(path: Path) -> list[FloatArray]:
    """Return the continuous subpaths of an SVG file as polylines, in document order.

    Straight lines are kept exactly; curves become chords that stay within `CHORD_TOLERANCE` of
    them.  Coordinates are the user units of the root element.  The y axis of SVG points down,
    so y changes its sign and the picture stands upright.  A path without ``Z`` stays open.
    Elements that are hidden by a style are read like any other.
    """
    root = ElementTree.parse(path).getroot()
    if _tag(root) != "svg":
        raise ValueError(f"the root element is <{_tag(root)}>, not <svg>")
    by_id = {element.get("id", ""): element for element in root.iter()}
    subpaths = list(_subpaths_of(root, np.eye(3), by_id))
    rough = [_sample(subpath, lambda curve, _: _points_on(curve, 8)) for subpath in subpaths]
    extent = float(np.ptp(np.concatenate(rough), axis=0).max()) if rough else 0.0
    return [_flatten(subpath, CHORD_TOLERANCE * extent) for subpath in subpaths]


def _tag(element: ElementTree.Element) -> str:
    """Return the name of an element without its namespace."""
    return str(element.tag).rpartition("}")[2]


def _subpaths_of(
    element: ElementTree.Element, outer: FloatArray, by_id: dict[str, ElementTree.Element]
) -> Iterator[_Subpath]:
    """Yield the subpaths of an element and of everything inside it."""
    transform = outer @ parse_transform(element.get("transform"), strict=True)
    name = _tag(element)
    if name in CONVERSIONS:
        for curves in _continuous(parse_path(CONVERSIONS[name](element))):
            yield _Subpath(curves, transform)
    elif name == "use":
        shift = np.eye(3)
        shift[:2, 2] = float(element.get("x", 0)), float(element.get("y", 0))
        target = by_id[(element.get("href") or element.get(_XLINK) or "").removeprefix("#")]
        content = target if _tag(target) == "symbol" else [target]
        for child in content:
            yield from _subpaths_of(child, transform @ shift, by_id)
    elif name not in _NOT_DRAWN:
        for child in element:
            yield from _subpaths_of(child, transform, by_id)


def _continuous(curves: Any) -> Iterator[list[Any]]:
    """Yield the runs of curves in which each starts where the one before it ended."""
    run: list[Any] = []
    for curve in curves:
        if run and run[-1].end != curve.start:
            yield run
            run = []
        run.append(curve)
    if run:
        yield run


def _points_on(curve: Any, n_chords: int) -> FloatArray:
    """Return equally spaced points on a curve, its ends exactly, shape (n_chords + 1, 2)."""
    inner = [curve.point(t) for t in np.linspace(0.0, 1.0, n_chords + 1)[1:-1]]
    numbers = np.array([curve.start, *inner, curve.end], dtype=np.complex128)
    return np.column_stack([numbers.real, numbers.imag])


def _apply(transform: FloatArray, points: FloatArray) -> FloatArray:
    """Return transformed points with the y axis turned up."""
    moved = points @ transform[:2, :2].T + transform[:2, 2]
    return np.column_stack([moved[:, 0], 0.0 - moved[:, 1]])


def _sample(subpath: _Subpath, points_of: Callable[[Any, FloatArray], FloatArray]) -> FloatArray:
    """Return the points of all curves, the shared ends once, transformed."""
    parts = [points_of(curve, subpath.transform) for curve in subpath.curves]
    points = np.concatenate([parts[0][:1], *(part[1:] for part in parts)])
    return _apply(subpath.transform, points)


def _flatten(subpath: _Subpath, tolerance: float) -> FloatArray:
    """Return the polyline that stays within the tolerance of a subpath."""
    return _sample(subpath, lambda curve, transform: _chords(curve, transform, tolerance))


def _chords(curve: Any, transform: FloatArray, tolerance: float) -> FloatArray:
    """Return points on a curve, dense enough once the transform is applied."""
    if isinstance(curve, Line):
        return _points_on(curve, 1)
    n_chords = 4
    while n_chords < MOST_CHORDS:
        # Three points inside every chord: one alone can sit on an inflection.
        fine = _apply(transform, _points_on(curve, 4 * n_chords))
        start, end = fine[:-1:4, None], fine[4::4, None]
        weight = np.array([0.25, 0.5, 0.75])[:, None]
        inside = fine[:-1].reshape(n_chords, 4, 2)[:, 1:]
        if np.linalg.norm(inside - (start + weight * (end - start)), axis=2).max() <= tolerance:
            break
        n_chords *= 2
    return _points_on(curve, n_chords)
