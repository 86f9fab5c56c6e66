"""The subject of an explorer page: everything that it shows of one model."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from tusqh.errors import ConfigError
from tusqh.explorer.command import Command, mesh_command
from tusqh.explorer.files_read import FILES_READ, TABLES_SHOWN
from tusqh.files import path_of
from tusqh.geometry.canonical import load_geometry
from tusqh.geometry.kinds import Geometry
from tusqh.geometry.units import ASSUMED
from tusqh.geometry.upright import Axis, upright_axis
from tusqh.meshes.export import read_vtu
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.sampling.fractions import VolumeFractions
from tusqh.sampling.io import load_fractions
from tusqh.settings.grid import Grid, Window
from tusqh.settings.model import Settings
from tusqh.settings.policy import Policy
from tusqh.settings.sampling import Sampling
from tusqh.threshold.selection import Selection

if TYPE_CHECKING:
    from tusqh.pipeline.result import Result


@dataclass(frozen=True, kw_only=True)
class MeshSubject:
    """What the pages about one material and about several show.

    Parameters
    ----------
    name
        Name of the model; any text.
    unit
        Unit of length of its geometry.
    up
        Axis that points up in the first view of a solid.
    command
        The command that makes its mesh.
    mesh
        The mesh.
    tables
        Tables that the page shows, by name.
    """

    name: str
    unit: str
    up: Axis
    command: Command
    mesh: VolumeMesh
    tables: dict[str, pd.DataFrame]


@dataclass(frozen=True, kw_only=True)
class Subject(MeshSubject):
    """A model of one material, with the tables named in `TABLES_SHOWN`.

    Parameters
    ----------
    name, unit, up, command, mesh, tables
        See `MeshSubject`.
    geometry
        The outline or soup, without repair.
    fractions
        Volume fractions of cells and sub-cells.
    curves
        Raw Betti numbers by plateau, see `tusqh.topology.topology.Topology.curves`.
    topologies
        Betti numbers of meshes by plateau, see `tusqh.threshold.plateaus.Plateaus.table`.
    diagram
        Persistence pairs, see `tusqh.topology.persistence.locate_pairs`.
    selection
        The chosen threshold.
    is_fitted
        Whether the boundary of the mesh was moved onto the geometry.
    """

    geometry: Geometry
    fractions: VolumeFractions
    curves: pd.DataFrame
    topologies: pd.DataFrame
    diagram: pd.DataFrame
    selection: Selection
    is_fitted: bool = False


def subject_of(result: Result, *, geometry: str, up: Axis | None = None) -> Subject:
    """Return the explorer's subject for a meshing result.

    Parameters
    ----------
    result
        The result of `tusqh.mesh`.
    geometry
        The geometry file, for the command.
    up
        Axis that points up; None: as the format has it.
    """
    cells = result.built.resolved.cells
    return Subject(
        name=result.name,
        unit=result.mesh.unit or ASSUMED,
        up=upright_axis(geometry, up),
        command=mesh_command(geometry, result.settings, name=result.name),
        geometry=result.geometry,
        fractions=result.fractions,
        curves=result.curves,
        topologies=result.topologies,
        diagram=result.diagram,
        selection=result.selection,
        mesh=result.mesh,
        tables={
            "defects": result.defects,
            "elements": result.judgement.elements,
            "verdict": result.judgement.verdict,
            "features": cells.features,
            "bridges": cells.bridge_table,
        },
        is_fitted=result.fit is not None,
    )


def read_subject(
    folder: Path,
    *,
    geometry: str | None = None,
    up: Axis | None = None,
    settings: Settings | None = None,
    fitted: bool | None = None,
) -> Subject:
    """Return the subject in a result folder, which has the model's name.

    Parameters
    ----------
    folder
        The folder.
    geometry
        The geometry file, for the command; None: the name that the folder records.
    up
        Axis that points up; None: as the format has it.
    settings
        How the model is meshed; None: the settings that the folder records.
    fitted
        Whether to show the fitted mesh; None: if the folder has one.

    Raises
    ------
    ConfigError
        Files are missing from the folder.
    """
    paths = find_files(folder, FILES_READ, what="a model", option="GEOMETRY")
    if fitted is None:
        fitted = path_of("fitted", folder).is_file()
    name = folder.resolve().name
    chosen: dict[str, Any] = json.loads(paths["selection"].read_text(encoding="utf-8"))
    fractions = load_fractions(paths["fractions"])
    shape = load_geometry(paths["geometry"])
    file = geometry or shape.name
    command = mesh_command(
        file, _known(chosen, fractions) if settings is None else settings, name=name
    )
    if settings is None:
        command = replace(command, note="unit, domain, rule and orientation are not known here")
    mesh = read_vtu(path_of("fitted", folder) if fitted else paths["mesh"], name=name)
    return Subject(
        name=name,
        unit=mesh.unit or ASSUMED,
        up=upright_axis(file, up),
        command=command,
        geometry=shape,
        fractions=fractions,
        curves=pd.read_csv(paths["curves"]),
        topologies=pd.read_csv(paths["topologies"]),
        diagram=pd.read_csv(paths["diagram"]),
        selection=Selection.from_dict(chosen),
        mesh=mesh,
        tables={table: pd.read_csv(paths[table]) for table in TABLES_SHOWN},
        is_fitted=fitted,
    )


def find_files(folder: Path, names: Sequence[str], *, what: str, option: str) -> dict[str, Path]:
    """Return the files of a result folder that a page needs, by name.

    Parameters
    ----------
    folder
        The folder.
    names
        Names of the files, see `tusqh.files`.
    what, option
        What the results are of, and what makes them in `tusqh mesh`, for the message.

    Raises
    ------
    ConfigError
        Files are missing from the folder.
    """
    paths = {name: path_of(name, folder) for name in names}
    missing = [path.name for path in paths.values() if not path.is_file()]
    if missing:
        raise ConfigError(
            f"{', '.join(missing)} missing",
            where=str(folder),
            expected=f"the results of {what}, with " + ", ".join(p.name for p in paths.values()),
            remedy=f"make it with the workflow, or with tusqh mesh {option} --results FOLDER",
        )
    return paths


def _known(chosen: Mapping[str, Any], fractions: VolumeFractions) -> Settings:
    """Return the settings of a model that can be read from its results."""
    grid = fractions.grid
    return Settings(
        grid=Grid(cells=grid.shape, placement="corner"),
        window=Window(lower=grid.origin, upper=grid.upper),
        sampling=Sampling(samples=fractions.samples),
        policy=Policy.from_dict(chosen["policy"]),
    )
