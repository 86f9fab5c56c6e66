"""The target of fitting for an envelope or a shell: the surface that the ball touches, or offsets.

Where the ball of an envelope touches one side of a piece of the geometry, the piece is part of the
boundary; where it touches both sides or none, it is not.  The boundary of a shell consists of
pieces that are moved along their normals by half its thickness, as far as nothing else is nearer.
Elsewhere, as at edges of open sheets, the boundary follows the level set of the fractions.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from tusqh.fitting.pieces import cut_pieces, normals_of, pick_samples, sizes_of
from tusqh.fitting.planar.outline_target import cut_segments, pick_planar_samples, sides_of_material
from tusqh.fitting.planar.winding import wind_around, wind_beside_cap
from tusqh.fitting.target import Target, to_cells
from tusqh.geometry.framed import to_frame
from tusqh.geometry.kinds import Surface
from tusqh.geometry.outline import Outline
from tusqh.grid import BoolArray, FloatArray
from tusqh.sampling.closing import close
from tusqh.sampling.fractions import VolumeFractions
from tusqh.sampling.inside import EnvelopeField, ShellField, UnionField, field_of
from tusqh.sampling.lattice import Box, Lattice
from tusqh.sampling.nearest_triangle import find_nearest, make_tree
from tusqh.sampling.orient import orient
from tusqh.sampling.winding_tree import plant, wind_beside
from tusqh.settings.sampling import Sampling

#: Relative difference of distances that edges between facets of a curved surface make.
_CURVED = 0.02
#: How far beyond the shell the winding number is asked, in cells.
_BEYOND = 1e-3


def target_of_made(
    geometry: Surface,
    fractions: VolumeFractions,
    sampling: Sampling,
    *,
    sides: Box | None = None,
    changed: BoolArray | None = None,
) -> Target:
    """Return where the boundary of a mesh of an envelope, a shell or a union should lie.

    Parameters
    ----------
    geometry
        The geometry.
    fractions
        The fractions from which the mesh was made.
    sampling
        How they were sampled; `inside` is not "winding".
    sides
        Box whose sides cut the material, in model units; None: the grid holds all of it.
    changed
        Cells that were added or removed on purpose, shape n.
    """
    grid, oriented = fractions.grid, orient(geometry, sampling.orientation).geometry
    box = None if sides is None else to_cells(np.asarray(sides, dtype=np.float64), grid)
    upper = np.array(grid.shape, dtype=np.float64)
    if isinstance(oriented, Outline):
        box = None if box is None else np.clip(box, 0.0, upper)
        within = np.array([np.zeros(2), upper]) if box is None else box
        cut = cut_segments(to_cells(oriented.points, grid)[oriented.segments], within)
    else:
        cut = cut_pieces(to_cells(oriented.points, grid)[oriented.triangles], upper)
    pieces, share = _on_boundary(cut, oriented, fractions, sampling)
    if sampling.domain == "outside":
        pieces = _turned(pieces)
    if grid.dim == 2:
        if box is not None:
            pieces = np.concatenate([pieces, sides_of_material(box, fractions)])
        points, normals, sample = pick_planar_samples(pieces, normals_of(pieces))
    else:
        points, normals, sample, _ = pick_samples(pieces)
    return Target(
        grid=grid,
        level=fractions.values,
        points=points,
        normals=normals,
        pieces=pieces,
        sample=sample,
        trusted=share,
        sides=box,
        changed=changed,
    )


def _on_boundary(
    pieces: FloatArray, geometry: Surface, fractions: VolumeFractions, sampling: Sampling
) -> tuple[FloatArray, float]:
    """Return the pieces that bound the material, directed outwards, and which share they are."""
    grid = fractions.grid
    made = field_of(to_frame(geometry, grid.frame), sampling, grid.cell_size)
    centres, normals = _in_space(pieces.mean(axis=1)), _in_space(normals_of(pieces))
    origin = _in_space(np.array([grid.origin]))[0]
    offset = 0.0
    if isinstance(made, EnvelopeField):
        envelope = made.on(Lattice.over_grid(grid, sampling.samples))
        places = origin + grid.cell_size * centres
        touched = [envelope.is_touched(places, way * normals) for way in (1, -1)]
        is_outer = [touched[0] & ~touched[1], touched[1] & ~touched[0]]
    else:
        assert isinstance(made, (ShellField, UnionField))
        shell = made if isinstance(made, ShellField) else made.shell
        offset = shell.radius / grid.cell_size
        corners = (shell.corners - origin) / grid.cell_size
        tree = make_tree(corners if corners.shape[1] == 3 else corners[:, [0, 1, 1]])
        places = [centres + way * offset * normals for way in (1, -1)]
        is_outer = [find_nearest(tree, at).distance >= offset * (1 - _CURVED) for at in places]
        if isinstance(made, UnionField):
            sign = made.sign(Lattice.over_grid(grid, sampling.samples))
            wind = _winding(geometry, fractions)
            for at, is_far, way in zip(places, is_outer, (1, -1), strict=True):
                is_far &= sign * wind(at + way * _BEYOND * normals) < 0.5
    kept = []
    for way, is_chosen in zip((1, -1), is_outer, strict=True):
        along = way * offset * normals_of(pieces[is_chosen])
        moved = pieces[is_chosen] + along[:, None]
        kept.append(moved if way > 0 else _turned(moved))
    sizes = sizes_of(pieces)
    n_sides = 1 if offset == 0 else 2
    total = sum(float(sizes[is_chosen].sum()) for is_chosen in is_outer)
    return np.concatenate(kept), total / max(n_sides * float(sizes.sum()), 1e-300)


def _winding(geometry: Surface, fractions: VolumeFractions) -> Callable[[FloatArray], FloatArray]:
    """Return the winding number at places in cells, shape (n, 3)."""
    grid = fractions.grid
    if isinstance(geometry, Outline):
        cycle, cap = (
            (to_cells(chain.corners[..., [0, 2]], grid), chain.multiplicity)
            for chain in close(geometry)
        )

        def wind(places: FloatArray) -> FloatArray:
            plane = places[:, [0, 2]]
            return wind_around(plane, *cycle) + wind_beside_cap(plane, *cap)

        return wind
    tree = plant(to_cells(geometry.points, grid)[geometry.triangles])
    return lambda places: wind_beside(tree, places, np.full(places.shape, 1e-6))[:, 0]


def _turned(pieces: FloatArray) -> FloatArray:
    """Return pieces with the opposite direction."""
    return np.ascontiguousarray(pieces[:, ::-1])


def _in_space(vectors: FloatArray) -> FloatArray:
    """Return vectors with three coordinates: in the plane x, 0, y, as in a lattice."""
    return vectors if vectors.shape[1] == 3 else np.insert(vectors, 1, 0.0, axis=1)
