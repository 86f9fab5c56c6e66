"""`tusqh mesh --slabs` and `tusqh check` of a mesh in pieces."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from tusqh.errors import ConfigError

if TYPE_CHECKING:
    import pandas as pd

    from tusqh.meshes.measure_pieces import PiecesMeasurement
    from tusqh.pipeline.slabs.mesh import SlabResult
    from tusqh.settings.model import Settings


def require_one_in_slabs(geometry: list[str], *, is_several: bool) -> None:
    """Raise an error if more than one geometry or material is to be meshed in slabs.

    Parameters
    ----------
    geometry
        The geometry files.
    is_several
        Whether several materials are asked for.

    Raises
    ------
    ConfigError
        There are several.
    """
    if is_several or len(geometry) > 1:
        raise ConfigError(
            "several materials with --slabs" if is_several else f"{len(geometry)} geometries",
            where="tusqh mesh",
            expected="one geometry of one material; several are not available in slabs",
            remedy="leave out --slabs",
        )


def mesh_slabs(
    geometry: str, settings: Settings, outputs: list[Path], results: Path | None
) -> SlabResult:
    """Write the mesh of a geometry, made in slabs.

    Parameters
    ----------
    geometry
        The geometry file.
    settings
        The settings of the command line.
    outputs
        Files to write.
    results
        Folder for the mesh with its certificate; None: none.

    Returns
    -------
    result
        Where the mesh is, and its report.
    """
    from tusqh.cli.progress import shown
    from tusqh.pipeline.slabs.mesh import mesh_in_slabs

    with shown() as progress:
        return mesh_in_slabs(geometry, settings, outputs, results=results, progress=progress)


def check_pieces(path: Path) -> tuple[pd.DataFrame, PiecesMeasurement]:
    """Return the checks of a mesh in pieces and of its certificate, and its measurement.

    Parameters
    ----------
    path
        The PVTU file.

    Returns
    -------
    checks, measurement
        See `tusqh.pipeline.slabs.recheck.check_in_pieces`.
    """
    from tusqh.pipeline.slabs.recheck import check_in_pieces

    return check_in_pieces(path)
