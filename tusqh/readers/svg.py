"""Read an SVG drawing: paths and basic shapes, transforms applied."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from svgpathtools import Line, parse_path
from svgpathtools.document import CONVERSIONS
from svgpathtools.parser import parse_transform

from tusqh.geometry.outline import Outline
from tusqh.grid import FloatArray
from tusqh.readers.curves import CHORD_TOLERANCE, flatten_curve
from tusqh.readers.reading import Reading

#: Elements whose content is drawn only when something else refers to it.
_NOT_DRAWN = {"defs", "symbol", "clipPath", "mask", "marker", "pattern"}

_XLINK = "{http://www.w3.org/1999/xlink}href"


@dataclass(frozen=True)
class _Subpath:
    """Continuous curves of one element and the transform, shape (3, 3), that applies to them."""

    curves: list[Any]
    transform: FloatArray


def read(path: Path) -> Reading:
    """Read the continuous subpaths as polylines, in document order.

    Straight lines are kept exactly; curves become chords that stay within `CHORD_TOLERANCE` of
    them.  Coordinates are the user units of the root element.  The y axis of SVG points down,
    so y changes its sign and the picture stands upright.  A path without ``Z`` stays open.
    Elements that are hidden by a style are read like any other.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    Reading
        The geometry.

    Raises
    ------
    ValueError
        The file is not SVG.
    GeometryError
        The outline is empty, without extent or not finite.
    """
    root = ElementTree.parse(path).getroot()
    if _tag(root) != "svg":
        raise ValueError(f"the root element is <{_tag(root)}>, not <svg>")
    by_id = {element.get("id", ""): element for element in root.iter()}
    subpaths = list(_subpaths_of(root, np.eye(3), by_id))
    rough = [_flatten(subpath, np.inf) for subpath in subpaths]
    extent = float(np.ptp(np.concatenate(rough), axis=0).max()) if rough else 0.0
    chains = [_flatten(subpath, CHORD_TOLERANCE * extent) for subpath in subpaths]
    return Reading(Outline.from_chains(chains, name=path.name))


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


def _points_at(curve: Any, transform: FloatArray, parameters: FloatArray) -> FloatArray:
    """Return transformed points on a curve, the y axis turned up, its ends exactly."""
    inner = [curve.point(t) for t in parameters[1:-1]]
    numbers = np.array([curve.start, *inner, curve.end], dtype=np.complex128)
    moved = np.column_stack([numbers.real, numbers.imag]) @ transform[:2, :2].T + transform[:2, 2]
    return np.column_stack([moved[:, 0], 0.0 - moved[:, 1]])


def _flatten(subpath: _Subpath, tolerance: float) -> FloatArray:
    """Return the polyline that stays within the tolerance of a subpath, shared ends once."""
    parts = []
    for curve in subpath.curves:
        points_at = partial(_points_at, curve, subpath.transform)
        is_straight = isinstance(curve, Line)
        ends = np.array([0.0, 1.0])
        parts.append(points_at(ends) if is_straight else flatten_curve(points_at, tolerance))
    return np.concatenate([parts[0][:1], *(part[1:] for part in parts)])
