"""Run programs that make solids from dirty surfaces, with one function for each.

`studies.peers` runs ``python -m studies.peer_meshers PEER INPUT.npz OUTPUT.npz SECONDS`` in a
separate process, because some of them crash or never end.
"""

from __future__ import annotations

import json
import resource
import sys
import tempfile
import time
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tusqh.grid import HEX_CORNERS, FloatArray, IntArray

if TYPE_CHECKING:
    from tusqh.meshes.volume_mesh import VolumeMesh
    from tusqh.pipeline.original import Original
    from tusqh.sampling.fractions import VolumeFractions
    from tusqh.threshold.selection import Selection

#: Exit status if a peer is not installed.
NOT_INSTALLED = 3

Arrays = dict[str, np.ndarray]
Solid = tuple[FloatArray, IntArray]

#: Corners of VTK's voxel in the order of its hexahedron.
_VOXEL_TO_HEX = [0, 1, 3, 2, 4, 5, 7, 6]


def mesh_by_automesh(given: Arrays) -> Solid:
    """Return the hexes that automesh makes from our kept cells; it takes voxels, not surfaces.

    Parameters
    ----------
    given
        The surface, the grid and the settings, as arrays.
    """
    import meshio

    automesh = import_module("automesh")

    with tempfile.TemporaryDirectory() as folder:
        voxels, out = Path(folder) / "voxels.npy", Path(folder) / "hexes.vtk"
        np.save(voxels, given["kept"].astype(np.uint8))
        elements = automesh.Voxels.from_npy(str(voxels)).as_finite_elements(
            remove=[0],
            scale=[float(given["cell_size"])] * 3,
            translate=given["origin"].tolist(),
        )
        elements.write_vtk(str(out))
        mesh = meshio.read(out)
    return mesh.points, mesh.cells_dict["hexahedron"]


def mesh_by_pytetwild(given: Arrays) -> Solid:
    """Return the tetrahedra that fTetWild makes from the surface with its own defaults.

    Parameters
    ----------
    given
        The surface, the grid and the settings, as arrays.
    """
    points, tets = import_module("pytetwild").tetrahedralize(
        given["points"], given["triangles"].astype(np.int32), quiet=True, vtk_ordering=True
    )
    return points, tets.astype(np.int64)


def mesh_by_pyvista(given: Arrays) -> Solid:
    """Return the voxels of our cell size inside the surface, by PyVista (VTK's image stencil).

    Parameters
    ----------
    given
        The surface, the grid and the settings, as arrays.
    """
    import pyvista

    faces = np.column_stack([np.full(len(given["triangles"]), 3), given["triangles"]])
    surface = pyvista.PolyData(given["points"], faces=faces.ravel())
    voxels = surface.voxelize(spacing=float(given["cell_size"]))
    corners = voxels.cells.reshape(-1, 9)[:, 1:]
    return np.array(voxels.points, dtype=np.float64), corners[:, _VOXEL_TO_HEX].astype(np.int64)


def mesh_by_trimesh(given: Arrays) -> Solid:
    """Return the voxels of our cell size that touch the surface or lie inside, by trimesh.

    Parameters
    ----------
    given
        The surface, the grid and the settings, as arrays.
    """
    import trimesh

    surface = trimesh.Trimesh(given["points"], given["triangles"], process=False)
    size = float(given["cell_size"])
    voxels = surface.voxelized(size).fill()
    corners = np.argwhere(voxels.matrix)[:, None] + HEX_CORNERS
    shape = np.add(voxels.matrix.shape, 1)
    numbers = np.ravel_multi_index(tuple(np.moveaxis(corners, -1, 0)), tuple(shape))
    used, cells = np.unique(numbers, return_inverse=True)
    lattice = np.stack(np.unravel_index(used, tuple(shape)), axis=1)
    # The transform maps indices to the centres of voxels.
    points = voxels.transform[:3, 3] + size * (lattice - 0.5)
    return points, cells.reshape(numbers.shape)


def mesh_by_tusqh(given: Arrays) -> Solid:
    """Return our hexes at the selected threshold, from the stages `sample` and `build`.

    The surface is sampled again so that the time includes sampling.

    Parameters
    ----------
    given
        The surface, the grid and the settings, as arrays.
    """
    mesh, _, _, _ = _mesh(given)
    return mesh.points, mesh.cells


def mesh_by_tusqh_fitted(given: Arrays) -> Solid:
    """Return our hexes with the boundary moved onto the surface.

    Parameters
    ----------
    given
        The surface, the grid and the settings, as arrays.
    """
    from tusqh.fitting import fit_mesh
    from tusqh.pipeline.fit import find_target

    mesh, selection, fractions, original = _mesh(given)
    target = find_target(mesh, selection, fractions, original)
    size, base = fractions.grid.cell_size, selection.base or selection.threshold
    fitted = fit_mesh(mesh, target, cell_size=size, threshold=base).mesh
    return fitted.points, fitted.cells


def _mesh(given: Arrays) -> tuple[VolumeMesh, Selection, VolumeFractions, Original]:
    """Return our mesh with the selection, the fractions and the geometry of which it was made."""
    from tusqh.geometry.soup import Soup
    from tusqh.pipeline.build import build
    from tusqh.pipeline.original import Original
    from tusqh.settings.model import Settings
    from tusqh.threshold.selection import Selection

    settings = Settings.from_dict(json.loads(str(given["settings"])))
    selection = Selection.from_dict(json.loads(str(given["selection"])))
    soup = Soup(given["points"], given["triangles"], given["parts"])
    original = Original(soup, settings.grid, settings.sampling, settings.window)
    fractions = original.sample()
    return build(fractions, selection).mesh, selection, fractions, original


PEERS: dict[str, Callable[[Arrays], Solid]] = {
    "tusqh": mesh_by_tusqh,
    "tusqh_fitted": mesh_by_tusqh_fitted,
    "automesh": mesh_by_automesh,
    "pytetwild": mesh_by_pytetwild,
    "pyvista": mesh_by_pyvista,
    "trimesh": mesh_by_trimesh,
}


def main(peer: str, source: Path, target: Path, limit: int) -> int:
    """Run a peer on the arrays in a file, write its results and times, and return the status.

    Parameters
    ----------
    peer
        One of `PEERS`.
    source, target
        The files to read and to write.
    limit
        Limit on processor time in s, which is independent of other work on the machine.

    Returns
    -------
    int
        0, or the exit code for the reason of a failure.
    """
    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 5))
    with np.load(source) as content:
        given = {key: content[key] for key in content.files}
    began, used = time.perf_counter(), time.process_time()
    try:
        points, cells = PEERS[peer](given)
    except ModuleNotFoundError as reason:
        sys.stderr.write(f"{reason}\n")
        return NOT_INSTALLED
    np.savez(
        target,
        points=points,
        cells=np.asarray(cells, dtype=np.int64),
        seconds=time.perf_counter() - began,
        processor_seconds=time.process_time() - used,
    )
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]), int(sys.argv[4])))
