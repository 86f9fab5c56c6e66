"""Measure a mesh of hexes in pieces, of which two are in memory at a time.

Points, edges, faces and elements are counted in every piece, and what neighbouring pieces share is
subtracted.  Components of the pieces are joined by a union-find over what they share.  Only the
boundary is held as a whole: manifoldness, hanging nodes and surfaces concern it alone.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tusqh.errors import MeshError
from tusqh.grid import FloatArray, IndexArray, IntArray
from tusqh.meshes.betti import betti_from_boundary, betti_from_euler
from tusqh.meshes.checks import Check, count_rows, to_checks
from tusqh.meshes.facets import Facets, count_edges, find_facets
from tusqh.meshes.hanging_nodes import count_hanging_nodes
from tusqh.meshes.jacobians import element_volumes, enclosed_volume, smallest_jacobians
from tusqh.meshes.manifold import find_non_manifold_points
from tusqh.meshes.numbering import (
    count_different_points,
    count_repeated_corners,
    count_used,
    number_rows,
)
from tusqh.meshes.seams import Examined, Piece, Seam, join
from tusqh.topology.betti_numbers import BettiNumbers


@dataclass(frozen=True)
class Skin:
    """The boundary of a mesh in pieces, as a whole.

    Parameters
    ----------
    points
        Coordinates of its points, shape (n, 3).
    boundary
        Points of its faces, facing outwards, shape (m, 4).
    """

    points: FloatArray
    boundary: IndexArray

    @cached_property
    def boundary_edges(self) -> Facets:
        """The edges of the faces, one row for each edge of each face."""
        return find_facets(self.boundary)


@dataclass(frozen=True)
class PiecesMeasurement:
    """The measurement of a mesh in pieces, with the properties of that of a whole mesh.

    Parameters
    ----------
    name
        The model, for messages.
    checks
        The checks of `tusqh.meshes.checks.check_mesh`, and that the pieces fit together.
    by_euler, by_boundary
        Betti numbers by two methods.
    smallest_scaled_jacobian, volume
        See `tusqh.meshes.measure.Measurement`.
    n_cells, n_points
        Number of elements and of points of the whole mesh.
    kinds
        The kinds of element that occur, ascending.
    enclosed
        Volume within the boundary, model units**3.
    """

    name: str
    checks: tuple[Check, ...]
    by_euler: BettiNumbers
    by_boundary: BettiNumbers
    smallest_scaled_jacobian: float
    volume: float
    n_cells: int
    n_points: int
    kinds: tuple[int, ...]
    enclosed: float

    @property
    def failed(self) -> tuple[Check, ...]:
        """The checks that the mesh does not pass."""
        return tuple(check for check in self.checks if not check.holds)

    @property
    def is_sound(self) -> bool:
        """Whether the mesh passes every check."""
        return not self.failed

    def has_topology(self, predicted: BettiNumbers) -> bool:
        """Return whether both methods measure the predicted Betti numbers.

        Parameters
        ----------
        predicted
            The Betti numbers predicted before meshing.
        """
        return self.by_euler == self.by_boundary == predicted


def measure_pieces(pieces: Iterable[Piece], *, name: str) -> PiecesMeasurement:
    """Return the measurement of a mesh from its pieces, in their order.

    Parameters
    ----------
    pieces
        The pieces; points are shared by neighbours in this order only.
    name
        The model, for messages.

    Raises
    ------
    MeshError
        A piece cannot be measured: its indices, coordinates or numbers are wrong, or pieces that
        are not neighbours share points.
    """
    found = _Found()
    before: Examined | None = None
    for number, piece in enumerate(pieces):
        _require_sound(piece, f"{name}, piece {number}")
        examined = Examined(piece)
        found.add(examined)
        if before is not None:
            found.join(join(before, examined))
            found.close(before)
        before = examined
    if before is None:
        raise MeshError(
            "has no pieces", where=name, expected="at least one", remedy="make the mesh again"
        )
    found.close(before)
    return found.finish(name)


def _require_sound(piece: Piece, where: str) -> None:
    """Raise an error if a piece has elements or points that prevent further checks."""
    cells, n = piece.cells, len(piece.points)
    faults = {"elements": 0 if len(cells) else 1}
    if len(cells):
        faults["indices_out_of_range"] = int(((cells < 0) | (cells >= n)).sum())
    if not any(faults.values()):
        faults |= {
            "non_finite_points": count_rows(~np.isfinite(piece.points)),
            "unused_points": n - count_used(cells),
            "repeated_corners": count_repeated_corners(cells),
            "numbers": int((np.diff(piece.numbers) <= 0).sum()),
        }
    wrong = [f"{key.replace('_', ' ')}: {count:,}" for key, count in faults.items() if count]
    if wrong:
        raise MeshError(
            f"cannot be measured: {'; '.join(wrong)}".replace("elements: 1", "no elements"),
            where=where,
            expected="elements with valid corners, and points with ascending numbers",
            remedy="make the mesh again, or check it as one file",
        )


class _Found:
    """Everything that is counted while pieces are read."""

    def __init__(self) -> None:
        self.n_of_piece: list[int] = []
        self.numbers_end = self.n_cells = self.n_points = self.euler = 0
        self.counts = dict.fromkeys(
            ("repeated_points", "repeated_elements", "overfull_facets", "inverted", "misplaced"), 0
        )
        self.scaled, self.volume = 1.0, 0.0
        self.kinds: set[int] = set()
        self.links: dict[str, list[IntArray]] = {"points": [], "facets": []}
        self.n_labels = {"points": [0], "facets": [0]}
        self.faces: list[IndexArray] = []
        self.places: list[tuple[IntArray, FloatArray]] = []
        self.is_used = np.zeros(0, dtype=bool)

    def add(self, examined: Examined) -> None:
        """Count what a piece has."""
        piece, facets = examined.piece, examined.facets
        self.n_cells += len(piece.cells)
        self.n_points += len(piece.points)
        self.euler += len(piece.points) - count_edges(piece.cells)
        self.euler += facets.n_unique - len(piece.cells)
        jacobians = smallest_jacobians(piece.points, piece.cells)
        self.scaled = float(np.minimum(self.scaled, jacobians.scaled.min()))
        self.counts["inverted"] += int((~(jacobians.determinant > 0)).sum())
        self.volume += float(element_volumes(piece.points, piece.cells).sum())
        self.counts["repeated_points"] += len(piece.points) - count_different_points(piece.points)
        n_different = number_rows(piece.cells, np.arange(8)[None])[1]
        self.counts["repeated_elements"] += len(piece.cells) - n_different
        self.counts["overfull_facets"] += int((facets.n_cells_of > 2).sum())
        self.kinds.update(np.unique(piece.kind).tolist())
        self.n_labels["points"].append(examined.by_points[1])
        self.n_labels["facets"].append(examined.by_facets[1])
        more = int(piece.numbers[-1]) + 1 - len(self.is_used)
        if more > 0:
            self.is_used = np.concatenate([self.is_used, np.zeros(more, dtype=bool)])
        self.is_used[piece.numbers] = True

    def join(self, seam: Seam) -> None:
        """Subtract what the last two pieces share."""
        self.n_points -= seam.n_points
        self.euler -= seam.n_points - seam.n_edges + seam.n_facets
        self.counts["overfull_facets"] += seam.overfull
        self.counts["repeated_elements"] += seam.repeated_elements
        self.counts["repeated_points"] += seam.repeated_points
        self.counts["misplaced"] += seam.misplaced
        for key, pairs in (("points", seam.by_points), ("facets", seam.by_facets)):
            offsets = np.cumsum(self.n_labels[key])[-3:-1]
            self.links[key].append(pairs + offsets)

    def close(self, examined: Examined) -> None:
        """Keep the boundary of a piece after both its neighbours were joined."""
        faces, rows = examined.open_faces()
        self.faces.append(faces)
        self.places.append((examined.piece.numbers[rows], examined.piece.points[rows]))

    def finish(self, name: str) -> PiecesMeasurement:
        """Return the measurement."""
        if int(self.is_used.sum()) != self.n_points:
            raise MeshError(
                "pieces that are not neighbours share points",
                where=name,
                expected="pieces of which only neighbours share points",
                remedy="check the mesh as one file",
            )
        skin, components = self._skin(), {key: self._count(key) for key in self.links}
        counts = self.counts
        checks = to_checks(
            {
                "indices_out_of_range": 0,
                "non_finite_points": 0,
                "unused_points": len(self.is_used) - self.n_points,
                "repeated_corners": 0,
                "repeated_points": counts["repeated_points"],
                "repeated_elements": counts["repeated_elements"],
                "overfull_facets": counts["overfull_facets"],
                "hanging_nodes": count_hanging_nodes(skin.points, skin.boundary),
                "non_manifold_points": len(find_non_manifold_points(skin)),
                "non_positive_jacobians": counts["inverted"],
                "misplaced_points": counts["misplaced"],
            }
        )
        return PiecesMeasurement(
            name=name,
            checks=tuple(checks),
            by_euler=betti_from_euler(components["points"], self.euler, skin.boundary),
            by_boundary=betti_from_boundary(components["facets"], skin),
            smallest_scaled_jacobian=self.scaled,
            volume=self.volume,
            n_cells=self.n_cells,
            n_points=self.n_points,
            kinds=tuple(sorted(self.kinds)),
            enclosed=enclosed_volume(skin.points, skin.boundary),
        )

    def _count(self, key: str) -> int:
        """Return the number of components of all pieces together."""
        n = int(np.sum(self.n_labels[key]))
        pairs = np.concatenate([np.empty((0, 2), dtype=np.int64), *self.links[key]])
        graph = coo_array((np.ones(len(pairs), dtype=bool), tuple(pairs.T)), shape=(n, n))
        return int(connected_components(graph, directed=False, return_labels=False))

    def _skin(self) -> Skin:
        """Return the boundary, its points numbered without gaps."""
        faces = np.concatenate(self.faces)
        numbers = np.concatenate([numbers for numbers, _ in self.places])
        points = np.concatenate([points for _, points in self.places])
        numbers, rows = np.unique(numbers, return_index=True)
        return Skin(points[rows], np.searchsorted(numbers, faces))
