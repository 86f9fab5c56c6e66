"""Compile the library's functions before several processes need them: ``python -m tusqh.compiled``.

numba compiles a function when it is first called and keeps it on disk.  Processes that start
together after an installation would all compile the same functions; here two processes share them.
"""

from __future__ import annotations

import compileall
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

from tusqh.grid import FloatArray, IntArray

#: The two shares, which take about the same time.
_SHARES = ("sampling", "meshing")


def is_compiled() -> bool:
    """Return whether numba has kept compiled functions, beside the modules or in its own folder."""
    beside = Path(__file__).parent / "sampling/__pycache__"
    return "NUMBA_CACHE_DIR" in os.environ or any(beside.glob("*.nbi"))


def write_bytecode(*folders: Path) -> None:
    """Write the bytecode of modules that changed, also where `PYTHONDONTWRITEBYTECODE` is set.

    Containers set it; every step of the workflow would then compile all modules that it imports.

    Parameters
    ----------
    *folders
        Folders of packages.
    """
    for folder in folders:
        compileall.compile_dir(folder, quiet=1)


def compile_functions() -> None:
    """Compile what meshing needs, in two processes.

    Functions for formats and options that few use are compiled when they are used.

    Raises
    ------
    subprocess.CalledProcessError
        One of the processes failed, and has printed why.
    """
    write_bytecode(Path(__file__).parent)
    command = [sys.executable, "-W", "ignore", "-m", "tusqh.compiled"]
    with subprocess.Popen([*command, _SHARES[0]]) as other:
        subprocess.run([*command, _SHARES[1]], check=True)
    if other.returncode:
        raise subprocess.CalledProcessError(other.returncode, other.args)


def _compile_sampling() -> None:
    """Sample surfaces and an outline with gaps, which also compiles what measures their defects."""
    from tusqh.geometry.kinds import Surface
    from tusqh.geometry.outline import Outline
    from tusqh.geometry.soup import Soup
    from tusqh.pipeline.ingest import describe_geometry
    from tusqh.pipeline.insides import compare_insides
    from tusqh.pipeline.sample import sample
    from tusqh.quality.thickness import measure_thickness
    from tusqh.readers.boxes_to_cubes import resample_turned
    from tusqh.settings.grid import Grid
    from tusqh.settings.model import Settings

    points, triangles = _ring()
    is_kept = np.arange(len(triangles)) != 5
    square = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, 0.5]])
    geometries: list[Surface] = [Outline.from_chains([square], name="plate")]
    for faces in (triangles, triangles[is_kept]):
        geometries.append(Soup(points, faces, np.zeros(len(faces), dtype=np.int64), name="ring"))
    compare_insides(geometries[-1], Settings(), cells=8)
    for geometry in geometries:
        describe_geometry(geometry)
        sample(geometry, grid=Grid(cells=8), threshold=0.5)
        measure_thickness(geometry)
    turn = np.array([[0.8, 0.6, 0.0], [-0.6, 0.8, 0.0], [0.0, 0.0, 2.0]])
    resample_turned(np.random.default_rng(0).random((2, 2, 2)), turn, np.zeros(3), 0.5)


def _compile_meshing() -> None:
    """Mesh noise, an outline and a ring, and fit them: everything that follows sampling."""
    from tusqh.geometry.image import Image
    from tusqh.geometry.outline import Outline
    from tusqh.pipeline.stages import run_stages
    from tusqh.settings.fitting import Fitting
    from tusqh.settings.grid import Grid
    from tusqh.settings.model import Settings

    noise = Image(np.random.default_rng(0).random((8, 8, 8)), name="noise")
    square = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, 0.0]])
    plates = [Outline.from_chains([chain], name="plate") for chain in (square, square[:-1])]
    for geometry in (noise, _ring(), *plates):
        result = run_stages(geometry, Settings(grid=Grid(cells=8), fitting=Fitting(fit=True)))
        _ = result.diagram, result.judgement
        if geometry is not noise:  # It has hundreds of classes, and two suffice.
            _ = result.prices


def _ring() -> tuple[FloatArray, IntArray]:
    """Return the points and triangles of a ring with a square section."""
    turns = np.arange(32) * (2 * np.pi / 32)
    around = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    section = np.array([[1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0]])
    points = np.array([[*(radius * way), z] for way in around for radius, z in section])
    triangles = []
    for turn in range(32):
        for side in range(4):
            a, b = 4 * turn + side, 4 * turn + (side + 1) % 4
            c, d = (a + 4) % len(points), (b + 4) % len(points)
            triangles += [[a, c, b], [b, c, d]]
    return points, np.array(triangles, dtype=np.int64)


if __name__ == "__main__":
    if len(sys.argv) == 1:
        compile_functions()
    else:
        {"sampling": _compile_sampling, "meshing": _compile_meshing}[sys.argv[1]]()
