"""Read an SVG drawing as the union of its filled elements, with transforms and clip paths."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import shapely

from tusqh.geometry.outline import Outline
from tusqh.geometry.remark import Remark
from tusqh.geometry.units import scaled
from tusqh.grid import FloatArray
from tusqh.readers.curves import CHORD_TOLERANCE
from tusqh.readers.loose import join_loose
from tusqh.readers.paint import paint, unite
from tusqh.readers.reading import Reading
from tusqh.readers.rings import is_closed, settle
from tusqh.readers.svg_frame import unit_of_root
from tusqh.readers.svg_shapes import flatten
from tusqh.readers.svg_tree import Clip, Shape, Walk


def read(path: Path) -> Reading:
    """Read the area that the elements of a drawing fill, or its lines if none is filled.

    Every element paints its area by its own fill rule, and the drawing is their union; rings
    without overlaps keep their points.  Straight lines are kept exactly; curves become chords that
    stay within `CHORD_TOLERANCE` of them.  If `width` or `height` of the root is in a real
    unit, coordinates are in that unit, otherwise in user units of the root.  The y axis of SVG
    points down, so the sign of y is changed to keep the picture upright.  A path
    without ``Z`` stays open.  Remarks list elements that are not painted, and text, images and
    everything else that is not read.

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
    walk, (size, unit) = Walk(root), unit_of_root(root)
    subpaths = [subpath for shape in walk.shapes for subpath in shape.subpaths]
    rough = [flatten(subpath, np.inf) for subpath in subpaths]
    extent = float(np.ptp(np.concatenate(rough), axis=0).max()) if rough else 0.0
    chains, remarks = _chains_of(walk.shapes, CHORD_TOLERANCE * extent)
    outline = scaled(Outline.from_chains(chains, name=path.name), size, unit=unit)
    return Reading(outline, (*walk.remarks(), *remarks), unit=unit)


def _chains_of(shapes: list[Shape], tolerance: float) -> tuple[list[FloatArray], list[Remark]]:
    """Return the rings of the filled area, or the lines if nothing is filled."""
    flat = [[flatten(subpath, tolerance) for subpath in shape.subpaths] for shape in shapes]
    if not all(np.isfinite(chain).all() for chains in flat for chain in chains):
        return [chain for chains in flat for chain in chains], []
    painted = []
    counts: Counter[str] = Counter()
    for shape, chains in zip(shapes, flat, strict=True):
        clip = None if not shape.clips else _region_of_clips(shape.clips, chains, tolerance)
        found = paint(chains, rule=shape.rule, clip=clip) if shape.is_filled else None
        if found is not None:
            painted.append(found)
            counts["clip"] += found.is_cut
        else:
            counts["lines"] += 1
    if not painted:
        loose, remarks = join_loose([chain for chains in flat for chain in chains])
        what = "elements without a fill read as lines"
        return loose, [Remark("noted", what, counts["lines"]), *remarks] if loose else []
    rings, sides, n_overlapping = unite(painted)
    settled, _ = settle(rings, sides)
    remarks = []
    n_open = sum(not is_closed(ring) for ring in settled)
    for effect, what, count in (
        ("left out", "elements that fill no area", counts["lines"]),
        ("changed", "elements cut by clip paths or viewports", counts["clip"]),
        ("changed", "elements united with others that they overlap", n_overlapping),
        ("noted", "filled paths that stay open", n_open),
    ):
        if count:
            remarks.append(Remark(effect, what, count))  # type: ignore[arg-type]
    return settled, remarks


def _region_of_clips(clips: tuple[Clip, ...], chains: list[FloatArray], tolerance: float) -> Any:
    """Return the region that remains visible under all clips of an element."""
    regions = []
    for clip in clips:
        parts = []
        for shape in clip.shapes_for(chains):
            flat = [flatten(subpath, tolerance) for subpath in shape.subpaths]
            inner = _region_of_clips(shape.clips, flat, tolerance) if shape.clips else None
            found = paint(flat, rule=shape.rule, clip=inner)
            parts += [found.region] if found is not None else []
        regions.append(shapely.union_all(parts) if parts else shapely.Polygon())
    region = regions[0]
    for other in regions[1:]:
        region = shapely.intersection(region, other)
    return region
