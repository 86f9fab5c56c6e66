"""The target of fitting in the plane: trusted pieces of an outline and the sides of the window."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tusqh.fitting.pieces import normals_of, sizes_of
from tusqh.fitting.planar.winding import wind_around, wind_beside_cap
from tusqh.fitting.target import Target, to_cells
from tusqh.geometry.outline import Outline
from tusqh.grid import BoolArray, FloatArray, IntArray
from tusqh.sampling.closing import close
from tusqh.sampling.fractions import VolumeFractions
from tusqh.sampling.lattice import Box

#: Longest piece, in cells.
SIZE = 0.25

#: How far on either side of a piece the winding number is asked, in cells.
_BESIDE = 0.03

#: Sizes of the boxes of which each gives one sample: of position in cells, and of normals.
_BOX, _BOX_OF_NORMALS = 0.25, 0.5

#: Segments this far outside the box still lie on its sides, in cells.
_ROUNDING = 1e-9

#: Number of emptiest and of fullest cells that show how fractions and winding numbers are related.
_N_COMPARED = 200


def target_of_outline(
    outline: Outline,
    fractions: VolumeFractions,
    *,
    sides: Box | None = None,
    changed: BoolArray | None = None,
) -> Target:
    """Return the target of an outline.

    A piece of a segment is trusted if the winding numbers on its two sides lie on both sides of
    1/2.  Doubled borders, and walls inside overlapping polygons, are not.  Where a side of the grid
    or of the window cuts the material, the side is part of the target.

    Parameters
    ----------
    outline
        The outline.
    fractions
        The fractions from which the mesh was made.
    sides
        The window, in model units; None: the sides of the grid.
    changed
        Cells that were added or removed on purpose, shape n.
    """
    grid = fractions.grid
    box = np.array([np.zeros(2), np.array(grid.shape, dtype=np.float64)])
    if sides is not None:
        window = to_cells(np.asarray(sides, dtype=np.float64), grid)
        box = np.array([np.maximum(box[0], window[0]), np.minimum(box[1], window[1])])
    cycle, cap = close(outline)
    inside = _Inside.of(
        (to_cells(cycle.corners[..., [0, 2]], grid), cycle.multiplicity),
        (to_cells(cap.corners[..., [0, 2]], grid), cap.multiplicity),
        fractions,
    )
    pieces = cut_segments(to_cells(outline.points, grid)[outline.segments], box)
    normals, centres = normals_of(pieces), pieces.mean(axis=1)
    before, behind = (inside(centres + s * _BESIDE * normals) for s in (1, -1))
    is_trusted = before != behind
    normals = np.where(before[:, None], -normals, normals)[is_trusted]
    lengths = sizes_of(pieces)
    share = float(lengths[is_trusted].sum() / max(lengths.sum(), 1e-300))
    on_sides, normals_of_sides = _sides(box)
    middle = on_sides.mean(axis=1)
    reaches = inside(middle - _BESIDE * normals_of_sides)
    reaches &= inside(middle + _BESIDE * normals_of_sides)
    pieces = np.concatenate([pieces[is_trusted], on_sides[reaches]])
    normals = np.concatenate([normals, normals_of_sides[reaches]])
    points, of_samples, sample = pick_planar_samples(pieces, normals)
    return Target(
        grid=grid,
        level=fractions.values,
        points=points,
        normals=of_samples,
        pieces=pieces,
        sample=sample,
        trusted=share,
        sides=box,
        changed=changed,
    )


@dataclass(frozen=True)
class _Inside:
    """The places where the material is, by winding numbers.

    Parameters
    ----------
    cycle, cap
        Ends of segments in cells, and their multiplicities.
    sign
        By which sign winding numbers give fractions.
    is_outside
        Whether the material lies outside the outline.
    """

    cycle: tuple[FloatArray, IntArray]
    cap: tuple[FloatArray, IntArray]
    sign: int = 1
    is_outside: bool = False

    @classmethod
    def of(
        cls,
        cycle: tuple[FloatArray, IntArray],
        cap: tuple[FloatArray, IntArray],
        fractions: VolumeFractions,
    ) -> _Inside:
        """Return the relation that agrees with the emptiest and the fullest cells."""
        cells = fractions.cells.ravel()
        order = np.argsort(cells, kind="stable")
        chosen = np.union1d(order[:_N_COMPARED], order[-_N_COMPARED:])
        at = np.unravel_index(chosen, fractions.grid.shape)
        places = np.stack(at, axis=1).astype(np.float64) + (0.5 + 1e-6)
        winding = cls(cycle, cap).wind(places)
        ways = [(1, False), (-1, False), (1, True), (-1, True)]
        errors = [
            np.abs((1 - s * winding if o else s * winding) - cells[chosen]).sum() for s, o in ways
        ]
        return cls(cycle, cap, *ways[int(np.argmin(errors))])

    def wind(self, places: FloatArray) -> FloatArray:
        """Return the winding number at places, shape (n,)."""
        return wind_around(places, *self.cycle) + wind_beside_cap(places, *self.cap)

    def __call__(self, places: FloatArray) -> BoolArray:
        """Return whether the material is at places, shape (n,)."""
        is_within = self.sign * self.wind(places) >= 0.5
        return np.asarray(~is_within if self.is_outside else is_within)


def cut_segments(ends: FloatArray, box: FloatArray) -> FloatArray:
    """Return the pieces of segments inside a box, each at most `SIZE` long, shape (p, 2, 2).

    Parameters
    ----------
    ends
        Ends of the segments, in cells, shape (m, 2, 2).
    box
        Lowest and highest corner, in cells, shape (2, 2).
    """
    start, along = ends[:, 0], ends[:, 1] - ends[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        at_low, at_high = (box[0] - start) / along, (box[1] - start) / along
    is_flat = along == 0
    is_out = (is_flat & ((start < box[0] - _ROUNDING) | (start > box[1] + _ROUNDING))).any(axis=1)
    first = np.where(is_flat, 0.0, np.minimum(at_low, at_high)).max(axis=1, initial=0.0)
    last = np.where(is_flat, 1.0, np.maximum(at_low, at_high)).min(axis=1, initial=1.0)
    length = np.linalg.norm(along, axis=1)
    kept = np.flatnonzero(~is_out & (last > first) & (length > 0))
    first, last = first[kept], last[kept]
    n = np.maximum(1, np.ceil((last - first) * length[kept] / SIZE)).astype(np.int64)
    row = np.repeat(np.arange(len(kept)), n)
    number = np.arange(len(row)) - np.repeat(np.cumsum(n) - n, n)
    step = ((last - first) / n)[row]
    begin = first[row] + number * step
    a = start[kept][row] + begin[:, None] * along[kept][row]
    b = start[kept][row] + (begin + step)[:, None] * along[kept][row]
    return np.stack([a, b], axis=1)


def target_of_level(fractions: VolumeFractions) -> Target:
    """Return the target of fractions in the plane whose geometry is not known: their level set.

    Parameters
    ----------
    fractions
        The fractions; the sides of the grid cut what their cells hold.

    Examples
    --------
    >>> from tusqh.grid import BackgroundGrid
    >>> grid = BackgroundGrid(shape=(2, 1), cell_size=1.0, origin=(0.0, 0.0))
    >>> target = target_of_level(VolumeFractions.from_values(grid, 4, np.ones((5, 3))))
    >>> target.pieces.shape, target.trusted
    ((24, 2, 2), 1.0)
    """
    box = np.array([np.zeros(2), np.array(fractions.grid.shape, dtype=np.float64)])
    pieces = sides_of_material(box, fractions)
    points, of_samples, sample = pick_planar_samples(pieces, normals_of(pieces))
    return Target(
        grid=fractions.grid,
        level=fractions.values,
        points=points,
        normals=of_samples,
        pieces=pieces,
        sample=sample,
        trusted=1.0,
        sides=box,
    )


def sides_of_material(box: FloatArray, fractions: VolumeFractions) -> FloatArray:
    """Return pieces of the sides of a box beside cells that are at least half full.

    Their material is on the left.

    Parameters
    ----------
    box
        Lowest and highest corner, in cells, shape (2, 2).
    fractions
        The fractions of the cells.
    """
    pieces, normals = _sides(box)
    upper = np.array(fractions.grid.shape) - 1
    cell = np.floor(pieces.mean(axis=1) - 0.5 * normals).astype(np.int64)
    cell = np.clip(cell, 0, upper)
    reaches = fractions.cells[cell[:, 0], cell[:, 1]] >= 0.5
    is_turned = (normals_of(pieces) * normals).sum(axis=1) < 0
    pieces[is_turned] = pieces[is_turned][:, ::-1]
    return np.asarray(pieces[reaches])


def _sides(box: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return pieces of the sides of a box, and their outward normals."""
    pieces, normals = [], []
    for axis in range(2):
        other = 1 - axis
        n = max(1, int(np.ceil((box[1, other] - box[0, other]) / SIZE)))
        places = np.linspace(box[0, other], box[1, other], n + 1)
        for end in range(2):
            piece = np.empty((n, 2, 2))
            piece[:, :, axis] = box[end, axis]
            piece[:, 0, other], piece[:, 1, other] = places[:-1], places[1:]
            normal = np.zeros((n, 2))
            normal[:, axis] = 2 * end - 1
            pieces.append(piece)
            normals.append(normal)
    return np.concatenate(pieces), np.concatenate(normals)


def pick_planar_samples(
    pieces: FloatArray, normals: FloatArray
) -> tuple[FloatArray, FloatArray, IntArray]:
    """Return the mean centre and normal of the pieces in each small box, and the box of each.

    Parameters
    ----------
    pieces
        Ends of the pieces, in cells, shape (p, 2, 2).
    normals
        Their unit normals, shape (p, 2).

    Returns
    -------
    points, normals
        Of each box, shape (s, 2) each.
    sample
        The box of each piece, shape (p,).
    """
    centres, lengths = pieces.mean(axis=1), sizes_of(pieces)
    place = np.concatenate([np.floor(centres / _BOX), np.rint(normals / _BOX_OF_NORMALS)], axis=1)
    numbers = np.unique(place.astype(np.int64), axis=0, return_inverse=True)[1]
    sample: IntArray = numbers.ravel().astype(np.int64)
    n = int(sample.max(initial=-1)) + 1
    total = np.bincount(sample, lengths, minlength=n)
    mean = [np.bincount(sample, lengths * v, minlength=n) for v in (*centres.T, *normals.T)]
    points = np.stack(mean[:2], axis=1) / np.maximum(total, 1e-300)[:, None]
    of_samples: FloatArray = np.stack(mean[2:], axis=1).astype(np.float64)
    of_samples /= np.maximum(np.linalg.norm(of_samples, axis=1), 1e-300)[:, None]
    return points, of_samples, sample
