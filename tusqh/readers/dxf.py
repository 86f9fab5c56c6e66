"""Read a DXF drawing: lines, polylines and curves of its model space.

DXF does not state what is inside, so loose lines are chained by their end points and the even-odd
rule defines the areas, see `tusqh.readers.loose`.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import ezdxf.path
import ezdxf.units
import numpy as np
from ezdxf.filemanagement import readfile

from tusqh.errors import GeometryError
from tusqh.geometry.outline import Outline
from tusqh.geometry.remark import Remark
from tusqh.grid import FloatArray
from tusqh.readers.curves import CHORD_TOLERANCE, flatten_curve
from tusqh.readers.logs import collect_logs, remarks_on_logs
from tusqh.readers.loose import join_loose
from tusqh.readers.reading import Reading

#: An arc of a polyline becomes a third as many Bezier curves, with an error of at most a millionth
#: of its radius.
_ARC_SEGMENTS = 24

#: Pattern for the unit of the drawing, which is in the header among the first bytes of the file.
_UNITS = re.compile(rb"\$INSUNITS\s+70\s+(\d{1,2})\b")
_HEADER = 1 << 18

_POLYLINES = ("LWPOLYLINE", "POLYLINE")
_CURVES = ("ARC", "CIRCLE", "ELLIPSE", "SPLINE")


def read(path: Path) -> Reading:
    """Read the entities as polylines, which are chained to outlines if their ends meet.

    The entities are LINE, LWPOLYLINE, POLYLINE, ARC, CIRCLE, ELLIPSE and SPLINE in model space,
    also inside blocks (INSERT).  The remarks count all other entities and those on layers that are
    off or frozen.  Straight lines are kept exactly; curves become chords within `CHORD_TOLERANCE`
    of them, relative to the drawing.  A polyline is closed only if its closed flag is set or its
    ends meet.  The third coordinate is dropped.

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
    with collect_logs("ezdxf") as texts:
        document = readfile(path)
    hidden = {
        layer.dxf.name.lower() for layer in document.layers if layer.is_off() or layer.is_frozen()
    }
    found = [(e, _reason_to_skip(e, hidden)) for e in _exploded(document.modelspace())]
    entities = [entity for entity, reason in found if not reason]
    skipped = Counter(reason for _, reason in found if reason)
    remarks = remarks_on_logs("ezdxf", texts)
    remarks += [Remark("left out", what, skipped[what]) for what in sorted(skipped)]
    n_paper = sum(len(layout) for layout in document.layouts if not layout.is_modelspace)
    if n_paper:
        remarks.append(Remark("left out", "entities of paper layouts", n_paper))
    if not entities and skipped:
        raise GeometryError(
            "the geometry is empty: no line or curve, but "
            + ", ".join(f"{skipped[what]:,} {what}" for what in sorted(skipped)),
            where=str(path),
            expected="lines, polylines, arcs, circles, ellipses or splines in model space",
            remedy="explode or trace these in the program that wrote the file, and turn hidden "
            "layers on",
        )
    tolerance = _tolerance_of(entities)
    chains = [_chain_of(entity, tolerance or 1.0) for entity in entities]
    joined, of_chains = join_loose(chains)
    remarks += [*_on_heights(entities), *of_chains]
    outline = Outline.from_chains(joined, name=path.name)
    return Reading(outline, tuple(remarks), unit=_unit_in(path))


def _unit_in(path: Path) -> str:
    """Return the unit of length in the header, because ezdxf assumes metres if there is none."""
    with path.open("rb") as file:
        stated = _UNITS.search(file.read(_HEADER))
    return (ezdxf.units.decode(int(stated[1])) or "") if stated else ""


def _tolerance_of(entities: list[Any]) -> float:
    """Return the tolerance of chords, estimated from the extent of the control points."""
    if not entities:
        return 0.0
    extent = ezdxf.path.bbox((ezdxf.path.make_path(e) for e in entities), fast=True).size
    return CHORD_TOLERANCE * float(max(extent.x, extent.y))


def _on_heights(entities: list[Any]) -> list[Remark]:
    """Return the remark on entities that do not lie in one plane of constant height."""
    paths = [ezdxf.path.make_path(entity) for entity in entities]
    heights = [[v.z for v in p.control_vertices()] for p in paths if len(p)]
    n_steep = sum(max(z) - min(z) > 1e-6 * (1 + abs(max(z))) for z in heights if z)
    what = "entities with different heights, seen from above"
    return [Remark("changed", what, n_steep)] if n_steep else []


def _exploded(entities: Iterable[Any]) -> Iterator[Any]:
    """Yield the entities after replacing block references by the entities that they show."""
    for entity in entities:
        if entity.dxftype() == "INSERT" and entity.block() is not None:
            copies = entity.multi_insert() if entity.mcount > 1 else [entity]
            for copy in copies:
                yield from _exploded(copy.virtual_entities())
        else:
            yield entity


def _reason_to_skip(entity: Any, hidden: set[str]) -> str:
    """Return a description of an entity that is left out; empty for lines and curves."""
    kind = entity.dxftype()
    if kind == "INSERT":
        return "references to blocks that the file does not have"
    if kind == "POLYLINE" and not (entity.is_2d_polyline or entity.is_3d_polyline):
        return "meshes (POLYLINE)"
    if kind != "LINE" and kind not in _POLYLINES and kind not in _CURVES:
        return f"{kind} entities"
    if entity.dxf.get("invisible", 0) or entity.dxf.get("layer", "0").lower() in hidden:
        return "lines and curves that are hidden, or on layers that are off or frozen"
    return ""


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
    # A periodic spline is defined only between these two knots, but ezdxf traverses all of them.
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
    """Return the polyline of a closed entity with its exact first point at the end."""
    if not is_closed or len(points) < 2:
        return points
    # The last point of a full circle equals its start up to rounding, so replace it.
    comes_back = np.abs(points[-1] - points[0]).max() <= 1e-12 * np.abs(points).max()
    return np.concatenate([points[:-1] if comes_back else points, points[:1]])
