"""The target of fitting: trusted samples of a surface, and the 1/2 level set of the fractions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tusqh.fitting.pieces import cut_pieces, pick_samples
from tusqh.geometry.image import Image
from tusqh.geometry.soup import Soup
from tusqh.grid import BackgroundGrid, BoolArray, FloatArray, IntArray
from tusqh.sampling.fractions import VolumeFractions
from tusqh.sampling.lattice import Box
from tusqh.sampling.orient import orient
from tusqh.sampling.winding_tree import WindingTree, plant, wind_beside
from tusqh.settings.sampling import Orientation

#: How far on either side of a facet the winding number is asked, in cells.
BESIDE = 0.06
#: Number of emptiest and of fullest cells that show how fractions and winding numbers are related.
_N_COMPARED = 200


@dataclass(frozen=True)
class Target:
    """Where the boundary of a mesh should lie; lengths in cells from the origin of the grid.

    Parameters
    ----------
    grid
        The background grid.
    level
        Fractions on the doubled grid, shape ``2 n + 1``; the boundary follows their 1/2 level set
        where no sample is near.
    points, normals
        Trusted samples of the surface and their normals, which point out of the material, shape
        (s, dim) each.
    pieces
        Corners of the trusted pieces of facets, shape (p, dim, dim), each at most `SIZE` long.
    sample
        The sample that represents each piece, shape (p,).
    trusted
        Share of the surface inside the grid that is trusted.
    sides
        Box whose sides cut the material, in cells: the boundary on them stays plane; None: no box.
    changed
        Cells that were added or removed on purpose, shape n: boundary facets beside them belong to
        no surface.
    """

    grid: BackgroundGrid
    level: FloatArray
    points: FloatArray
    normals: FloatArray
    pieces: FloatArray
    sample: IntArray
    trusted: float = 0.0
    sides: FloatArray | None = None
    changed: BoolArray | None = None

    @classmethod
    def of(
        cls,
        geometry: Soup | Image,
        fractions: VolumeFractions,
        *,
        orientation: Orientation = "auto",
        sides: Box | None = None,
        changed: BoolArray | None = None,
    ) -> Target:
        """Return the target of a soup or an image.

        A piece of a triangle is trusted if the winding numbers a little above and below it lie on
        both sides of 1/2.  Inner walls, doubled sheets and dropped borders are not.

        Parameters
        ----------
        geometry
            The geometry; images have no samples, only the level set.
        fractions
            The fractions from which the mesh was made.
        orientation
            How the fractions were sampled, see `tusqh.sampling.orient.orient`.
        sides
            Box whose sides cut the material, in model units, such as the window.
        changed
            Cells that were added or removed on purpose, shape n.
        """
        grid = fractions.grid
        box = None if sides is None else to_cells(np.asarray(sides, dtype=np.float64), grid)
        level = fractions.values
        if isinstance(geometry, Image):
            none = np.zeros((0, grid.dim))
            empty = np.zeros((0, grid.dim, grid.dim))
            no_rows = np.zeros(0, dtype=np.int64)
            return cls(grid, level, none, none, empty, no_rows, 0.0, box, changed)
        oriented = orient(geometry, orientation).geometry
        assert isinstance(oriented, Soup)
        corners = to_cells(oriented.points, grid)[oriented.triangles]
        pieces = cut_pieces(corners, np.array(grid.shape, dtype=np.float64))
        samples = pick_samples(pieces)
        tree = plant(corners)
        sign, is_outside = _relation(tree, fractions)
        beside = wind_beside(tree, samples.points, BESIDE * samples.normals)
        is_inside = (sign * beside >= 0.5) ^ is_outside
        is_trusted = is_inside[:, 0] != is_inside[:, 1]
        normals = np.where(is_inside[:, :1], -samples.normals, samples.normals)
        is_kept = is_trusted[samples.sample]
        number = np.cumsum(is_trusted) - 1
        area = samples.areas
        return cls(
            grid=grid,
            level=level,
            points=samples.points[is_trusted],
            normals=normals[is_trusted],
            pieces=pieces[is_kept],
            sample=number[samples.sample[is_kept]],
            trusted=float(area[is_kept].sum() / max(area.sum(), 1e-300)),
            sides=box,
            changed=changed,
        )


def to_cells(points: FloatArray, grid: BackgroundGrid) -> FloatArray:
    """Return points in cells from the origin of a grid, shape (n, dim).

    Parameters
    ----------
    points
        Points in model units, shape (n, dim).
    grid
        The grid.
    """
    return grid.to_lattice(points)


def _relation(tree: WindingTree, fractions: VolumeFractions) -> tuple[int, bool]:
    """Return by which sign fractions follow from winding numbers, and whether they are 1 less it.

    The emptiest and the fullest cells decide.
    """
    cells = fractions.cells.ravel()
    order = np.argsort(cells, kind="stable")
    chosen = np.union1d(order[:_N_COMPARED], order[-_N_COMPARED:])
    index = np.unravel_index(chosen, fractions.grid.shape)
    places = np.stack(index, axis=1).astype(np.float64) + 0.5
    winding = wind_beside(tree, places, np.full(places.shape, 1e-6))[:, 0]
    wanted = cells[chosen]
    ways = [(1, False), (-1, False), (1, True), (-1, True)]
    errors = [np.abs((1 - s * winding if o else s * winding) - wanted).sum() for s, o in ways]
    return ways[int(np.argmin(errors))]
