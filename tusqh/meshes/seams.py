"""What two neighbouring pieces of a mesh of hexes share: points, edges, faces and elements."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tusqh.grid import BoolArray, FloatArray, IndexArray, IntArray
from tusqh.meshes.facets import HEX_EDGES, HEX_FACETS, Facets, find_facets
from tusqh.meshes.labelling import Labels, label_elements, label_points
from tusqh.meshes.numbering import count_different_points, number_rows


@dataclass(frozen=True)
class Piece:
    """A piece of a mesh of hexes; points at its ends are in both neighbouring pieces.

    Parameters
    ----------
    points
        Coordinates, in model units, shape (n, 3).
    numbers
        Number of each point in the whole mesh, ascending, shape (n,).
    cells
        Points of every element, as rows of `points`, shape (m, 8).
    kind
        Kind of every element, shape (m,).
    grid_cell
        Flat grid cell in which each element lies, shape (m,).
    """

    points: FloatArray
    numbers: IntArray
    cells: IndexArray
    kind: NDArray[np.int8]
    grid_cell: IntArray


class Examined:
    """A piece with its facets, components, and the faces that only one element has so far.

    Parameters
    ----------
    piece
        The piece.
    """

    def __init__(self, piece: Piece) -> None:
        self.piece = piece
        self.facets: Facets = find_facets(piece.cells)
        self.is_open: BoolArray = self.facets.on_boundary.copy()

    @cached_property
    def by_points(self) -> tuple[Labels, int]:
        """The components of points, and their number."""
        return label_points(self.piece.cells, len(self.piece.points))

    @cached_property
    def by_facets(self) -> tuple[Labels, int]:
        """The components of elements that share faces, and their number."""
        return label_elements(self.facets.unique, len(HEX_FACETS))

    def open_faces(self) -> tuple[IndexArray, IntArray]:
        """Return the open faces and their points.

        Returns
        -------
        faces
            The open faces, facing outwards, as numbers of the whole mesh, shape (m, 4).
        rows
            Their points, as rows of those of the piece, ascending, shape (k,).
        """
        cell, side = np.divmod(np.flatnonzero(self.is_open), len(HEX_FACETS))
        faces = self.piece.cells[cell[:, None], HEX_FACETS[side]]
        return self.piece.numbers[faces], np.unique(faces)


@dataclass(frozen=True)
class Seam:
    """What two neighbouring pieces share.

    Parameters
    ----------
    n_points, n_edges, n_facets
        Number of different points, edges and faces that are in both pieces.
    overfull, repeated_elements, repeated_points, misplaced
        Faces of more than two elements, elements that are in both, points with equal coordinates
        but different numbers, and points whose coordinates differ between the pieces.
    by_points, by_facets
        Pairs of components of the two pieces that touch, shape (r, 2).
    """

    n_points: int
    n_edges: int
    n_facets: int
    overfull: int
    repeated_elements: int
    repeated_points: int
    misplaced: int
    by_points: IntArray
    by_facets: IntArray


def join(first: Examined, second: Examined) -> Seam:
    """Return what two pieces share; faces that both have are open no more.

    Parameters
    ----------
    first, second
        The pieces.
    """
    a, b = first.piece, second.piece
    common, of_a, of_b = _common(a.numbers, b.numbers)
    index = [_index(piece, rows) for piece, rows in ((a, of_a), (b, of_b))]
    pieces = (first, second)
    facets = [_parts(p.piece.cells, at, HEX_FACETS) for p, at in zip(pieces, index, strict=True)]
    number, n = _number([points for points, _ in facets])
    counts = np.stack([np.bincount(own, minlength=n) for own in number])
    is_common = np.asarray((counts > 0).all(axis=0))
    holder = np.zeros((2, n), dtype=np.int64)
    for k, (piece, own, (_, rows)) in enumerate(zip(pieces, number, facets, strict=True)):
        holder[k, own] = piece.by_facets[0][rows // len(HEX_FACETS)]
        piece.is_open[rows[is_common[own]]] = False
    overfull = (counts.sum(axis=0) > 2).sum() - (counts > 2).sum()
    edges, n_edges = _number(
        [_parts(p.piece.cells, at, HEX_EDGES)[0] for p, at in zip(pieces, index, strict=True)]
    )
    has_edge = np.stack([np.bincount(own, minlength=n_edges) > 0 for own in edges])
    in_both = np.asarray(has_edge.all(axis=0))
    labels = np.stack([first.by_points[0][of_a], second.by_points[0][of_b]], axis=1)
    return Seam(
        n_points=len(common),
        n_edges=int(in_both.sum()),
        n_facets=int(is_common.sum()),
        overfull=int(overfull),
        repeated_elements=_repeated_elements(pieces, index),
        repeated_points=_repeated_points(a, b),
        misplaced=int((a.points[of_a] != b.points[of_b]).any(axis=1).sum()),
        by_points=np.unique(labels, axis=0).astype(np.int64),
        by_facets=np.unique(holder.T[is_common], axis=0),
    )


def _common(a: IntArray, b: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """Return the entries of two ascending arrays that are in both, and their rows."""
    at = np.minimum(np.searchsorted(b, a), len(b) - 1)
    of_a = np.flatnonzero(b[at] == a)
    return a[of_a], of_a, at[of_a]


def _index(piece: Piece, rows: IntArray) -> IntArray:
    """Return the place of every point of a piece among the common points, -1 for others."""
    index = np.full(len(piece.points), -1, dtype=np.int64)
    index[rows] = np.arange(len(rows))
    return index


def _parts(cells: IndexArray, index: IntArray, local: IntArray) -> tuple[IntArray, IntArray]:
    """Return the parts of elements with common points only, and their rows."""
    near = np.flatnonzero((index[cells] >= 0).sum(axis=1) >= local.shape[1])
    points = index[cells[near]][:, local]
    element, part = np.nonzero((points >= 0).all(axis=2))
    return points[element, part], near[element] * len(local) + part


def _number(parts: list[IntArray]) -> tuple[list[IndexArray], int]:
    """Return equal numbers for equal parts of both pieces, and how many there are."""
    both = np.concatenate(parts)
    numbers, n = number_rows(both, np.arange(both.shape[1])[None])
    return [numbers[: len(parts[0])], numbers[len(parts[0]) :]], n


def _repeated_elements(pieces: tuple[Examined, Examined], index: list[IntArray]) -> int:
    """Return how many elements of the second piece are in the first."""
    whole = np.arange(8)[None]
    parts = [_parts(p.piece.cells, at, whole)[0] for p, at in zip(pieces, index, strict=True)]
    n = _number(parts)[1]
    return sum(number_rows(own, whole)[1] for own in parts) - n


def _repeated_points(a: Piece, b: Piece) -> int:
    """Return how many points of both pieces have equal coordinates but different numbers."""
    low = np.maximum(a.points.min(axis=0), b.points.min(axis=0))
    high = np.minimum(a.points.max(axis=0), b.points.max(axis=0))
    near = [((p.points >= low) & (p.points <= high)).all(axis=1) for p in (a, b)]
    points = [p.points[at] for p, at in zip((a, b), near, strict=True)]
    numbers = [p.numbers[at] for p, at in zip((a, b), near, strict=True)]
    is_new = ~np.isin(numbers[1], numbers[0])
    both = np.concatenate([points[0], points[1][is_new]])
    repeated = [len(p) - count_different_points(p) for p in (both, *points)]
    return repeated[0] - repeated[1] - repeated[2]
