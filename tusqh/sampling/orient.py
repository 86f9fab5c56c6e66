"""Turn the parts of a geometry that point inwards, before its winding number is computed.

A part outside all others encloses material, so it is turned if its volume is negative.  A part
inside others keeps its direction relative to the one around it; if the two directions are opposite,
it is a cavity.  A cavity holds nothing to remove, so a part inside it encloses material again.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from tusqh.geometry.connected_parts import ConnectedParts, find_parts
from tusqh.geometry.kinds import Surface
from tusqh.geometry.remark import Remark
from tusqh.geometry.soup import Soup
from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.settings.sampling import Orientation

#: If the ratio of a part's volume to that of a ball of equal area is below this, its sign is noise.
_LEAST_ROUNDNESS_CLOSED, _LEAST_ROUNDNESS_OPEN = 1e-9, 0.05
#: Number of points of a part that are tested for lying inside another part.
_N_TESTED = 16
#: A point with at least this winding number is not outside, even if it lies on an edge of a box.
_NOT_OUTSIDE = 0.2
_SHOWN = 3


class Oriented(NamedTuple):
    """A geometry whose parts point outwards, and what a user must know about directions."""

    geometry: Surface
    remarks: tuple[Remark, ...] = ()


def orient(geometry: Surface, orientation: Orientation) -> Oriented:
    """Return a geometry whose parts point outwards, and remarks on what was turned.

    Parameters
    ----------
    geometry
        The geometry; only a soup has parts.
    orientation
        ``"auto"`` turns parts and triangles; other values only count them.

    Returns
    -------
    Oriented
        The geometry (the same object if nothing is turned), with remarks on parts that point
        inwards, triangles that disagree with their neighbours, and surfaces without an inside.
    """
    if not isinstance(geometry, Soup):
        return Oriented(geometry)
    key = f"orient {orientation}"
    if key not in geometry.remembered:
        geometry.remembered[key] = _orient_soup(geometry, orientation)
    found: Oriented = geometry.remembered[key]
    return found


def _orient_soup(geometry: Soup, orientation: Orientation) -> Oriented:
    """Return a soup whose parts point outwards, and remarks on what was turned."""
    with np.errstate(over="ignore", invalid="ignore"):  # Sampling explains extreme coordinates.
        parts = find_parts(geometry)
    if len(parts.volumes) == 0:
        return Oriented(geometry)
    is_turned, is_cavity = _turned_parts(geometry, parts)
    is_auto = orientation == "auto"
    remarks = _remarks(parts, is_turned, is_cavity, is_auto=is_auto)
    wrong = parts.is_reversed ^ (is_turned[parts.part] & (parts.part >= 0))
    if not is_auto or not wrong.any():
        return Oriented(geometry, remarks)
    triangles = geometry.triangles.copy()
    triangles[wrong] = triangles[wrong][:, ::-1]
    return Oriented(replace(geometry, triangles=triangles), remarks)


def _turned_parts(soup: Soup, parts: ConnectedParts) -> tuple[BoolArray, BoolArray]:
    """Return which parts must be turned, and which are cavities afterwards."""
    n = len(parts.volumes)
    is_turned = np.zeros(n, dtype=np.bool_)
    is_cavity = np.zeros(n, dtype=np.bool_)
    has_inside = _has_inside(parts)
    if not (has_inside & (parts.volumes < 0)).any():
        return is_turned, is_cavity
    order = np.argsort(-np.abs(parts.volumes), kind="stable")
    corners = soup.points[soup.triangles]
    by_part = np.argsort(parts.part, kind="stable")
    ends = np.searchsorted(parts.part[by_part], np.arange(n + 1))
    members = [by_part[a:b] for a, b in pairwise(ends.tolist())]
    done = np.zeros(n, dtype=np.bool_)
    for i in order[has_inside[order]].tolist():
        around = done & (parts.lower <= parts.lower[i]).all(axis=1)
        around &= (parts.upper >= parts.upper[i]).all(axis=1)
        candidates = np.flatnonzero(around)
        tested = corners[_some(members[i])].mean(axis=1)
        inside = [j for j in candidates.tolist() if _lies_in(tested, corners[members[j]])]
        is_negative = parts.volumes[i] < 0
        surrounding = sum(-1 if is_cavity[j] else 1 for j in inside)
        if surrounding <= 0:
            is_turned[i] = is_negative
        else:
            nearest = min(inside, key=lambda j: abs(parts.volumes[j]))
            is_turned[i] = is_turned[nearest]
            is_cavity[i] = is_negative ^ is_turned[i]
        done[i] = True
    return is_turned, is_cavity


def _has_inside(parts: ConnectedParts) -> BoolArray:
    """Return which parts enclose enough for their sign to mean something."""
    with np.errstate(divide="ignore", invalid="ignore"):
        roundness = 6 * np.sqrt(np.pi) * np.abs(parts.volumes) / parts.areas**1.5
    least = np.where(parts.is_closed, _LEAST_ROUNDNESS_CLOSED, _LEAST_ROUNDNESS_OPEN)
    return np.asarray(roundness > least)


def _some(triangles: IntArray) -> IntArray:
    """Return a few of many triangles, evenly spaced."""
    return triangles[np.linspace(0, len(triangles) - 1, _N_TESTED).astype(np.int64)]


def _lies_in(points: FloatArray, corners: FloatArray) -> bool:
    """Return whether points lie in the part with some triangles, by its winding number."""
    winding = np.zeros(len(points))
    for k, point in enumerate(points):
        a, b, c = np.moveaxis(corners - point, 1, 0)
        la, lb, lc = (np.linalg.norm(side, axis=1) for side in (a, b, c))
        numerator = np.einsum("mi,mi->m", a, np.cross(b, c))
        denominator = la * lb * lc + np.einsum("mi,mi->m", a, b) * lc
        denominator += np.einsum("mi,mi->m", b, c) * la + np.einsum("mi,mi->m", c, a) * lb
        winding[k] = abs(np.arctan2(numerator, denominator).sum() / (2 * np.pi))
        if winding[k] < _NOT_OUTSIDE:
            return False
    return bool(winding.mean() > 0.5)


def _remarks(
    parts: ConnectedParts, is_turned: BoolArray, is_cavity: BoolArray, *, is_auto: bool
) -> tuple[Remark, ...]:
    """Return what a user must know about the directions of triangles."""
    without = ~_has_inside(parts) & ~parts.is_closed
    set_auto = "" if is_auto else "set `orientation: auto` to turn them"
    said = "turned" if is_auto else "found"
    remarks = [
        Remark(
            "changed" if is_auto else "noted",
            f"triangles {said} that point the other way than their neighbours",
            int(parts.is_reversed.sum()),
            set_auto,
        ),
        Remark(
            "changed" if is_auto else "noted",
            f"parts {said} that point inwards: {_names(parts, is_turned)}",
            int(is_turned.sum()),
            set_auto or "set `orientation: as-is` to keep them",
        ),
        Remark(
            "noted",
            f"parts inside others that are cavities: {_names(parts, is_cavity)}",
            int(is_cavity.sum()),
        ),
        Remark(
            "noted",
            "edges whose triangles disagree, on surfaces that have only one side",
            parts.n_disagreeing,
            "correct the surface: it has no inside",
        ),
        Remark(
            "noted",
            "open parts",
            int((~parts.is_closed & ~without).sum()),
            "close their gaps if the volume matters",
        ),
        Remark(
            "noted",
            "open sheets without an inside",
            int(without.sum()),
            "close them to solids, or leave them out",
        ),
    ]
    return tuple(remark for remark in remarks if remark.count)


def _names(parts: ConnectedParts, is_chosen: BoolArray) -> str:
    """Describe the first few chosen parts, each by its number, triangles and bounding box."""
    chosen = np.flatnonzero(is_chosen)
    sizes = np.bincount(parts.part[parts.part >= 0], minlength=len(is_chosen))
    names = []
    for k in chosen[:_SHOWN].tolist():
        lower, upper = (", ".join(f"{x:.4g}" for x in b[k]) for b in (parts.lower, parts.upper))
        names.append(f"part {k + 1} of {sizes[k]:,} triangles, ({lower}) to ({upper})")
    more = [f"and {len(chosen) - _SHOWN} more"] if len(chosen) > _SHOWN else []
    return "; ".join([*names, *more])
