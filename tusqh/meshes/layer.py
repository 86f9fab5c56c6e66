"""Make one layer of hexes from a mesh of quads."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tusqh.errors import ConfigError
from tusqh.grid import IntArray
from tusqh.meshes.facets import HEX_FACETS
from tusqh.meshes.sets import FacetSet, NamedSets
from tusqh.meshes.volume_mesh import VolumeMesh

#: The face of a hex over each side of its quad, and at its bottom and top, as in `HEX_FACETS`.
_OVER_SIDES = np.array([2, 1, 3, 0])
_BACK, _FRONT = 4, 5


def extrude(mesh: VolumeMesh, sets: NamedSets, thickness: float) -> tuple[VolumeMesh, NamedSets]:
    """Return one layer of hexes over quads, with the sets of the quads, `back` and `front`.

    `back` lies at z = 0 and `front` at z = `thickness`; they have the numbers 5 and 6.

    Parameters
    ----------
    mesh
        The quads.
    sets
        Their named sets.
    thickness
        Thickness of the layer, in model units.

    Returns
    -------
    hexes
        The mesh.
    sets
        Its sets.

    Raises
    ------
    ConfigError
        The mesh is not plane, or the thickness is not positive.

    Examples
    --------
    >>> from tusqh.meshes.sets import find_sets
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> quad = VolumeMesh.from_arrays(square, [[0, 1, 2, 3]])
    >>> hexes, sets = extrude(quad, find_sets(quad), 0.5)
    >>> float(hexes.volumes[0]), [found.name for found in sets.once]
    (0.5, ['x_min', 'x_max', 'y_min', 'y_max', 'back', 'front'])
    """
    if mesh.dim != 2 or not (np.isfinite(thickness) and thickness > 0):
        raise ConfigError(
            "the mesh is not plane" if mesh.dim != 2 else f"found {thickness!r}",
            where="option --layer",
            expected="the thickness, above 0, of a layer over a mesh of quads",
            remedy="leave the option out" if mesh.dim != 2 else "give a positive number",
        )
    n = len(mesh.points)
    low = np.column_stack([mesh.points, np.zeros(n)])
    high = np.column_stack([mesh.points, np.full(n, float(thickness))])
    cells = np.hstack([mesh.cells, mesh.cells + n])
    hexes = VolumeMesh(
        points=np.concatenate([low, high]),
        cells=cells,
        kind=mesh.kind,
        grid_cell=mesh.grid_cell,
        name=mesh.name,
        unit=mesh.unit,
    )
    facets = [_over(found, cells) for found in sets.facets]
    everywhere = np.arange(mesh.n_cells)
    for number, name, local in ((5, "back", _BACK), (6, "front", _FRONT)):
        own = np.full(mesh.n_cells, local)
        meaning = f"{'lower' if local == _BACK else 'upper'} side of the layer"
        corners = cells[:, HEX_FACETS[local]]
        facets.append(FacetSet(number, name, "plane", meaning, corners, everywhere, own, False))
    facets.sort(key=lambda found: (found.is_repeated, found.number))
    points = [p._replace(points=np.concatenate([p.points, p.points + n])) for p in sets.points]
    return hexes, replace(sets, facets=facets, points=points)


def _over(found: FacetSet, cells: IntArray) -> FacetSet:
    """Return the faces of hexes over sides of quads."""
    local = _OVER_SIDES[found.local]
    corners = cells[found.element[:, None], HEX_FACETS[local]]
    return found._replace(local=local, corners=corners)
