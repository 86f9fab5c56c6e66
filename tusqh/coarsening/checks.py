"""Checks of a coarse mesh.

Those of the mesh that it stands for come on top; a conforming mesh is checked itself.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tusqh.antialias.scheme import Scheme
from tusqh.coarsening.coarse_mesh import CoarseMesh
from tusqh.coarsening.conforming import ConformingMesh
from tusqh.coarsening.transition import LEAST
from tusqh.meshes.checks import Check
from tusqh.meshes.volume_mesh import VolumeMesh

#: Largest distance of a hanging vertex from the middle of its parents, in cells.
_IN_THE_MIDDLE = 1e-9


def check_coarse(coarse: CoarseMesh) -> list[Check]:
    """Return the checks of sizes, of hanging vertices and of the volume.

    Parameters
    ----------
    coarse
        The mesh.
    """
    steps = _largest_step(coarse)
    n_free = _count_unconstrained(coarse)
    volumes = float(coarse.mesh.volumes.sum()), coarse.uniform.measurement.volume
    difference = abs(volumes[0] - volumes[1])
    return [
        Check(
            id="coarse_sizes",
            name="levels between elements that meet",
            found=steps,
            required="at most 1",
            holds=steps <= 1,
        ),
        Check(
            id="coarse_hanging",
            name="hanging vertices that no element constrains",
            found=n_free,
            required="0",
            holds=n_free == 0,
        ),
        Check(
            id="coarse_volume",
            name="volume of the coarse elements",
            found=f"{volumes[0]:.12g}",
            required=f"{volumes[1]:.12g}, that of the grid cells",
            holds=difference <= 1e-9 * volumes[1],
        ),
    ]


def check_conforming(coarse: ConformingMesh) -> list[Check]:
    """Return the check of the elements of a conforming mesh that the mesh before did not have.

    Parameters
    ----------
    coarse
        The mesh.
    """
    found = coarse.least_new
    return [
        Check(
            id="coarse_jacobian",
            name="smallest scaled Jacobian of the elements inside",
            found=f"{found:.6f}",
            required=f">= {LEAST}",
            holds=found >= LEAST,
        )
    ]


def with_transitions(scheme: Scheme) -> Scheme:
    """Return a scheme whose meshes were coarsened and conform.

    Parameters
    ----------
    scheme
        That of the mesh before.
    """
    bounds = {dim: min(bound, LEAST) for dim, bound in scheme.bounds.items()}
    on_sides = min(scheme.on_sides, LEAST)
    return Scheme(f"{scheme.name}, coarser inside", bounds, on_sides=on_sides)


def check_same_domain(coarse: ConformingMesh, mesh: VolumeMesh) -> list[Check]:
    """Return the checks of a conforming mesh against the mesh from which it was made.

    Parameters
    ----------
    coarse
        The conforming mesh.
    mesh
        The mesh before.
    """
    now, before = coarse.mesh.measurement, mesh.measurement
    return [
        Check(
            id="coarse_topology",
            name="Betti numbers of the coarse mesh",
            found=str(now.by_euler),
            required=f"{before.by_euler}, as before",
            holds=now.is_sound and now.has_topology(before.by_euler),
        ),
        Check(
            id="coarse_volume",
            name="volume of the coarse elements",
            found=f"{now.volume:.12g}",
            required=f"{before.volume:.12g}, as before",
            holds=abs(now.volume - before.volume) <= 1e-9 * before.volume,
        ),
    ]


def level_of_cells(coarse: CoarseMesh) -> NDArray[np.int8]:
    """Return the level of the element in each cell of the grid, -1 where there is none.

    Parameters
    ----------
    coarse
        The mesh.
    """
    level = np.full(coarse.grid.shape, -1, dtype=np.int8)
    own = coarse.mesh.grid_cell[~coarse.is_block]
    level.reshape(-1)[own[own >= 0]] = 0
    for size in np.unique(coarse.sizes).tolist():
        starts = coarse.starts[coarse.sizes == size]
        inner = np.stack(np.meshgrid(*coarse.grid.dim * [np.arange(size)], indexing="ij"), axis=-1)
        places = starts[:, None, :] + inner.reshape(1, -1, coarse.grid.dim)
        level[tuple(places.reshape(-1, coarse.grid.dim).T)] = size.bit_length() - 1
    return level


def _largest_step(coarse: CoarseMesh) -> int:
    """Return the largest difference between the levels of cells that share at least a vertex.

    A block that touches an empty cell or the side of the grid counts as two levels above it.
    """
    level = np.pad(level_of_cells(coarse), 1, constant_values=-1)
    lowest = level
    for axis in range(level.ndim):
        moved = np.moveaxis(lowest, axis, 0)
        least = moved.copy()
        least[1:] = np.minimum(least[1:], moved[:-1])
        least[:-1] = np.minimum(least[:-1], moved[1:])
        lowest = np.moveaxis(least, 0, axis)
    step = np.where(level > 0, level - lowest, 0)
    return int(step.max(initial=0))


def _count_unconstrained(coarse: CoarseMesh) -> int:
    """Return the number of hanging vertices without parents or away from their middle."""
    vertex, first, second = coarse.hanging.T
    points = coarse.mesh.points
    off = np.abs(points[vertex] - (points[first] + points[second]) / 2)
    is_off = off.max(axis=1, initial=0) > _IN_THE_MIDDLE * coarse.grid.cell_size
    return int((is_off | (first < 0) | (second < 0)).sum())
