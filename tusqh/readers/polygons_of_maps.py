"""Make the outlines of maps from polygons of rings, and from lines beside them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import shapely

from tusqh.geometry.outline import Outline
from tusqh.geometry.remark import Remark
from tusqh.grid import FloatArray
from tusqh.readers.loose import join_loose
from tusqh.readers.reading import Reading
from tusqh.readers.rings import (
    SLIP,
    count_copies,
    crossing_area,
    is_closed,
    regions_of,
    rings_of_region,
    settle,
    turned_remark,
)


@dataclass
class Map:
    """The content of a map.

    Parameters
    ----------
    rings
        Rings of all polygons, in file order.
    sides
        1 for outer rings, -1 for holes.
    outer
        Number of each ring's outer ring in its polygon; an outer ring has its own number.
    places
        Location of each ring in the file, for remarks.
    lines
        Lines, in file order.
    n_points
        Number of points in the file.
    feature_of
        Number of the feature to which each ring belongs.
    features
        Name of every feature, empty if it has none.
    """

    rings: list[FloatArray] = field(default_factory=list)
    sides: list[int] = field(default_factory=list)
    outer: list[int] = field(default_factory=list)
    places: list[str] = field(default_factory=list)
    lines: list[FloatArray] = field(default_factory=list)
    n_points: int = 0
    feature_of: list[int] = field(default_factory=list)
    features: list[str] = field(default_factory=list)

    def begin_feature(self, name: str) -> None:
        """Begin a feature, to which the following rings belong.

        Parameters
        ----------
        name
            Its name; empty if it has none.
        """
        self.features.append(name)

    def add_polygon(self, rings: Sequence[FloatArray], place: str) -> None:
        """Add a polygon: its outer ring, then its holes.

        Parameters
        ----------
        rings
            The rings.
        place
            Where it is in the file.
        """
        first = len(self.rings)
        for k, ring in enumerate(rings):
            self.rings.append(ring)
            self.sides.append(-1 if k else 1)
            self.outer.append(first)
            self.places.append(f"{place}, ring {k}")
            self.feature_of.append(len(self.features) - 1)

    def add_hole(self, ring: FloatArray, place: str) -> None:
        """Add a hole that is known to lie in another ring.

        Parameters
        ----------
        ring
            The ring.
        place
            Where it is in the file.
        """
        self.outer.append(len(self.rings))
        self.rings.append(ring)
        self.sides.append(-1)
        self.places.append(place)
        self.feature_of.append(len(self.features) - 1)


def reading_of_map(
    found: Map, *, name: str, unit: str = "", remarks: Sequence[Remark] = ()
) -> Reading:
    """Return the outline of a map, with remarks.

    The place of a ring in its polygon determines its direction, self-crossing rings enclose their
    even-odd area, and holes beside their outer ring are left out.  Lines bound an area only if
    there are no polygons.

    Parameters
    ----------
    found
        The map.
    name
        The name of the file.
    unit
        Unit of length of its coordinates; empty if it is not known.
    remarks
        Remarks of the reader.

    Raises
    ------
    GeometryError
        The outline is empty, without extent or not finite.
    """
    said = list(remarks)
    said += [Remark("left out", "points", found.n_points)] if found.n_points else []
    if not any(len(ring) > 2 for ring in found.rings):
        chains, of_lines = join_loose([*found.rings, *found.lines])
        return Reading(Outline.from_chains(chains, name=name), (*said, *of_lines), unit=unit)
    if found.lines:
        what = "lines beside polygons"
        said.append(Remark("left out", what, len(found.lines), "they bound no area"))
    n_open = sum(len(ring) > 0 and not is_closed(ring) for ring in found.rings)
    if n_open:
        said.append(Remark("noted", "polygon rings that do not end where they start", n_open))
    if not all(np.isfinite(ring).all() for ring in found.rings):
        return Reading(Outline.from_chains(found.rings, name=name), tuple(said), unit=unit)
    rings, sides, features, of_rings = _resolve(found)
    chains, n_turned = settle(rings, sides)
    said += [*of_rings, *turned_remark(n_turned), *count_copies(rings, sides)]
    outline = Outline.from_chains(chains, name=name)
    if found.features:
        parts = np.array(features, dtype=np.int64)[outline.chains]
        outline = replace(outline, parts=parts, part_names=tuple(found.features))
    return Reading(outline, tuple(said), unit=unit)


def _resolve(found: Map) -> tuple[list[FloatArray], list[int], list[int], list[Remark]]:
    """Return rings without self-crossings, their sides and features, and remarks on changes."""
    whole = [k for k, ring in enumerate(found.rings) if len(ring) > 2]
    regions: list[Any] = [None] * len(found.rings)
    for k, region in zip(whole, regions_of([found.rings[k] for k in whole]), strict=True):
        regions[k] = region
    rings: list[FloatArray] = []
    sides: list[int] = []
    features: list[int] = []
    places: dict[str, list[str]] = {"crossing": [], "slip": [], "beside": []}
    for k, (ring, region) in enumerate(zip(found.rings, regions, strict=True)):
        off = crossing_area(ring, region) if region is not None else 0.0
        owner = regions[found.outer[k]]
        if found.sides[k] < 0 and region is not None and shapely.disjoint(region, owner):
            places["beside"].append(found.places[k])
        elif off > SLIP:
            places["crossing"].append(found.places[k])
            pieces, of_pieces = rings_of_region(region)
            rings += pieces
            sides += [side * found.sides[k] for side in of_pieces]
        else:
            if off > 1e-9:
                places["slip"].append(found.places[k])
            rings.append(ring)
            sides.append(found.sides[k])
        features += [found.feature_of[k]] * (len(rings) - len(features))
    return rings, sides, features, _remarks_on(places)


def _remarks_on(places: dict[str, list[str]]) -> list[Remark]:
    """Return the remarks on self-crossing rings, and on holes that remove nothing."""
    remarks = []
    if places["crossing"]:
        what = f"self-crossing rings read by the even-odd rule ({_listed(places['crossing'])})"
        remarks.append(Remark("changed", what, len(places["crossing"]), "check these rings"))
    if places["slip"]:
        what = (
            "rings that cross themselves and lose less than a thousandth of their area "
            f"({_listed(places['slip'])})"
        )
        remarks.append(Remark("noted", what, len(places["slip"])))
    if places["beside"]:
        what = f"holes beside the outer ring of their polygon ({_listed(places['beside'])})"
        remedy = "write them as polygons if they are material"
        remarks.append(Remark("left out", what, len(places["beside"]), remedy))
    return remarks


def _listed(places: list[str]) -> str:
    """Return up to five places as text."""
    more = f" and {len(places) - 5} more" if len(places) > 5 else ""
    return "; ".join(places[:5]) + more
