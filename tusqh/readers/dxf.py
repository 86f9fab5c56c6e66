"""Read a DXF drawing: lines, polylines and curves of its model space."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import ezdxf.path
import numpy as np
from ezdxf.filemanagement import readfile

from tusqh.geometry.outline import Outline
from tusqh.grid import FloatArray
from tusqh.readers.curves import CHORD_TOLERANCE, flatten_curve
from tusqh.readers.reading import Reading

#: A polyline's arc becomes a third as many Bezier curves: a millionth of its radius off at most.
_ARC_SEGMENTS = 24

_POLYLINES = ("LWPOLYLINE", "POLYLINE")
_CURVES = ("ARC", "CIRCLE", "ELLIPSE", "SPLINE")


def read(path: Path) -> Reading:
    """Read the entities as polylines, in file order.

    Read are LINE, LWPOLYLINE, POLYLINE, ARC, CIRCLE, ELLIPSE and SPLINE in model space, also
    inside blocks (INSERT); meshes, text, hatches and dimensions are skipped.  Straight
    lines are kept exactly, curves become chords within `CHORD_TOLERANCE` of them, relative to
    the drawing.  A polyline closes only if its closed flag says so.  The third coordinate is
    dropped.

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
    GeometryError
        The outline is empty, without extent or not finite.
    """
    space = readfile(path).modelspace()
    entities = [entity for entity in _exploded(space) if _is_line_work(entity)]
    extent = ezdxf.path.bbox(
        (ezdxf.path.make_path(entity) for entity in entities), fast=True
    ).size  # of the control points, so never too small by much
    tolerance = CHORD_TOLERANCE * max(extent.x, extent.y) if entities else 0.0
    chains = [_chain_of(entity, tolerance or 1.0) for entity in entities]
    return Reading(Outline.from_chains(chains, name=path.name))


def _exploded(entities: Iterable[Any]) -> Iterator[Any]:
    """Yield the entities with block references replaced by what they show."""
    for entity in entities:
        if entity.dxftype() == "INSERT":
            copies = entity.multi_insert() if entity.mcount > 1 else [entity]
            for copy in copies:
                yield from _exploded(copy.virtual_entities())
        else:
            yield entity


def _is_line_work(entity: Any) -> bool:
    """Whether an entity is a line or a curve."""
    kind = entity.dxftype()
    if kind == "POLYLINE":
        return bool(entity.is_2d_polyline or entity.is_3d_polyline)
    return kind == "LINE" or kind in _POLYLINES or kind in _CURVES


def _chain_of(entity: Any, tolerance: float) -> FloatArray:
    """Return the polyline of one entity."""
    kind = entity.dxftype()
    if kind == "LINE":
        return _as_points([entity.dxf.start, entity.dxf.end])
    if kind in _POLYLINES:
        is_closed = bool(entity.closed if kind == "LWPOLYLINE" else entity.is_closed)
        if entity.has_arc:
            path = ezdxf.path.make_path(entity, segments=_ARC_SEGMENTS)
            return _closed(_as_points(path.flattening(tolerance)), is_closed)
        in_wcs = entity.vertices_in_wcs if kind == "LWPOLYLINE" else entity.points_in_wcs
        return _closed(_as_points(in_wcs()), is_closed)
    if kind == "SPLINE":
        return _closed(_flatten_spline(entity, tolerance), bool(entity.closed))
    is_full = kind == "CIRCLE" or (
        kind == "ELLIPSE"
        and math.isclose(abs(entity.dxf.end_param - entity.dxf.start_param), math.tau)
    )
    return _closed(_as_points(entity.flattening(tolerance)), is_full)


def _flatten_spline(entity: Any, tolerance: float) -> FloatArray:
    """Return the polyline of a spline."""
    spline = entity.construction_tool()
    knots, degree = spline.knots(), spline.degree
    # A periodic spline is defined only between these two of its knots; ezdxf walks them all.
    first, last = knots[degree], knots[len(knots) - 1 - degree]
    return flatten_curve(
        lambda t: _as_points(spline.points(first + t * (last - first))),
        tolerance,
        fewest=4 * spline.count,
    )


def _as_points(vertices: Iterable[Any]) -> FloatArray:
    """Return vertices as points, shape (n, 2)."""
    return np.array([(v.x, v.y) for v in vertices], dtype=np.float64).reshape(-1, 2)


def _closed(points: FloatArray, is_closed: bool) -> FloatArray:
    """Return the polyline of a closed entity with its first point, exactly, at the end."""
    if not is_closed or len(points) < 2:
        return points
    # A full circle comes back to its start only up to rounding: that is its last point already.
    comes_back = np.abs(points[-1] - points[0]).max() <= 1e-12 * np.abs(points).max()
    return np.concatenate([points[:-1] if comes_back else points, points[:1]])
