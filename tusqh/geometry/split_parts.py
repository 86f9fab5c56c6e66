"""Split a geometry into its parts, each a geometry of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from tusqh.geometry.connected_parts import find_parts
from tusqh.geometry.kinds import Surface
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup import Soup
from tusqh.grid import FloatArray, IntArray


def split_parts(geometry: Surface) -> list[Surface]:
    """Return the parts of a geometry in the order of its file.

    The parts of a soup are the objects, solids or nodes of its file; if there is only one, its
    connected pieces.  A piece that points inwards is a cavity of the smallest piece around it.  The
    parts of an outline are the features of its map; if there is only one, its chains, in the same
    way.

    Parameters
    ----------
    geometry
        The geometry.

    Examples
    --------
    >>> square = np.array([[0.0, 0], [4, 0], [4, 4], [0, 4], [0, 0]])
    >>> hole, beside = 1 + square[::-1] / 4, square + 5
    >>> [part.n_segments for part in split_parts(Outline.from_chains([square, hole, beside]))]
    [8, 4]
    """
    if isinstance(geometry, Outline):
        number = _numbers(geometry.parts)
        if number.max(initial=0) == 0:
            number = _pieces_of_outline(geometry)[geometry.chains]
        return [
            replace(
                geometry,
                **_used("segments", geometry.points, geometry.segments[number == k]),
                chains=geometry.chains[number == k],
                name=f"{geometry.name}, part {k + 1}",
                parts=None if geometry.parts is None else geometry.parts[number == k],
            )
            for k in range(int(number.max()) + 1)
        ]
    number = _numbers(geometry.parts)
    if number.max() == 0:
        number = _pieces_of_soup(geometry)
    return [
        replace(
            geometry,
            **_used("triangles", geometry.points, geometry.triangles[number == k]),
            parts=geometry.parts[number == k],
            name=f"{geometry.name}, part {k + 1}",
        )
        for k in range(int(number.max()) + 1)
    ]


def names_of(pieces: Sequence[Surface]) -> list[str]:
    """Return the names that a file states for the parts of its geometry, empty where it has none.

    The connected pieces of one part have no names of their own.

    Parameters
    ----------
    pieces
        The parts, see `split_parts`.

    Examples
    --------
    >>> corner = np.eye(3), np.array([[0, 1, 2]])
    >>> names_of(split_parts(Soup.from_parts([corner, corner], part_names=["ring", ""])))
    ['ring', '']
    """
    numbers = [0 if piece.parts is None else int(piece.parts[0]) for piece in pieces]
    if len(set(numbers)) < len(numbers):
        return [""] * len(pieces)
    return [
        piece.part_names[k] if k < len(piece.part_names) else ""
        for piece, k in zip(pieces, numbers, strict=True)
    ]


def _used(kind: str, points: FloatArray, simplices: IntArray) -> dict[str, Any]:
    """Return some simplices as an argument of that name, and the points that they use."""
    used, number = np.unique(simplices, return_inverse=True)
    return {"points": points[used], kind: number.reshape(simplices.shape).astype(np.int64)}


def _numbers(parts: IntArray | None) -> IntArray:
    """Return the numbers of parts without gaps."""
    if parts is None:
        return np.zeros(0, dtype=np.int64)
    return np.unique(parts, return_inverse=True)[1].astype(np.int64)


def _pieces_of_soup(soup: Soup) -> IntArray:
    """Return the connected piece of every triangle, shape (m,); -1 for flat ones."""
    found = find_parts(soup)
    joined = _join_cavities(found.volumes, found.lower, found.upper)
    first = np.full(int(joined.max(initial=-1)) + 1, len(found.part))
    is_proper = found.part >= 0
    np.minimum.at(first, joined[found.part[is_proper]], np.flatnonzero(is_proper))
    in_order = np.argsort(np.argsort(first, kind="stable"), kind="stable")
    return np.where(is_proper, in_order[joined[found.part]], -1)


def _pieces_of_outline(outline: Outline) -> IntArray:
    """Return the piece of every chain, shape (n_chains,)."""
    n = int(outline.chains.max()) + 1
    start, end = np.moveaxis(outline.points[outline.segments], 1, 0)
    lower, upper = np.full((n, 2), np.inf), np.full((n, 2), -np.inf)
    for ends in (start, end):
        np.minimum.at(lower, outline.chains, ends)
        np.maximum.at(upper, outline.chains, ends)
    middle = (lower + upper)[outline.chains] / 2
    (a, b), (c, d) = (start - middle).T, (end - middle).T
    areas = np.bincount(outline.chains, weights=(a * d - b * c) / 2).astype(np.float64)
    return _join_cavities(areas, lower, upper)


def _join_cavities(volumes: FloatArray, lower: FloatArray, upper: FloatArray) -> IntArray:
    """Return the number of every piece after joining cavities, those of negative volume.

    If all pieces are negative, the whole geometry is inside out and no piece is a cavity.
    """
    owner = np.arange(len(volumes))
    if (volumes > 0).any():
        for k in np.flatnonzero(volumes < 0):
            around = (
                (volumes > 0) & (lower <= lower[k]).all(axis=1) & (upper >= upper[k]).all(axis=1)
            )
            if around.any():
                owner[k] = np.where(around, volumes, np.inf).argmin()
    return np.unique(owner, return_inverse=True)[1].astype(np.int64)
