"""Everything about one model that its explorer shows."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from tusqh.errors import ConfigError
from tusqh.explorer.command import Command
from tusqh.geometry.files import load_geometry
from tusqh.meshes.export import read_vtu
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.sampling.fractions import Geometry, VolumeFractions
from tusqh.sampling.io import load_fractions
from tusqh.threshold.select import Selection

#: Tables that the page shows as they are.
TABLES = ("defects", "elements", "verdict", "features", "bridges")

#: Files of a result folder that an explorer is made of.
FILES = (
    *("geometry.vtp", "fractions.npz", "plateaus.csv", "topologies.csv", "diagram.csv"),
    *("threshold.json", "mesh.vtu", *(f"{table}.csv" for table in TABLES)),
)


@dataclass(frozen=True)
class Subject:
    """A model with its mesh and every table about it.

    Parameters
    ----------
    name
        The model, any text.
    unit
        Unit of length of its geometry.
    command
        The command that makes its mesh.
    geometry
        The outline or soup, as it is.
    fractions
        Volume fractions of cells and sub-cells.
    curves
        Raw Betti numbers by plateau, see `tusqh.topology.curves.betti_curves`.
    topologies
        Betti numbers of meshes by plateau, see `tusqh.threshold.plateaus.predict_plateaus`.
    diagram
        Persistence pairs, see `tusqh.topology.persistence.locate_pairs`.
    selection
        The chosen threshold.
    mesh
        The mesh at it.
    tables
        `TABLES` by name.
    """

    name: str
    unit: str
    command: Command
    geometry: Geometry
    fractions: VolumeFractions
    curves: pd.DataFrame
    topologies: pd.DataFrame
    diagram: pd.DataFrame
    selection: Selection
    mesh: VolumeMesh
    tables: dict[str, pd.DataFrame]


def read_subject(folder: Path, *, name: str, unit: str, command: Command) -> Subject:
    """Return what a result folder holds about its model.

    Raises
    ------
    ConfigError
        Files are missing from the folder.
    """
    missing = [file for file in FILES if not (folder / file).is_file()]
    if missing:
        raise ConfigError(
            f"no {', '.join(missing)} in it",
            where=str(folder),
            expected="the result folder of a model, with " + ", ".join(FILES),
            remedy=f"make them: snakemake --cores 2 {folder}/explorer.html",
        )
    chosen: dict[str, Any] = json.loads((folder / "threshold.json").read_text(encoding="utf-8"))
    return Subject(
        name=name,
        unit=unit,
        command=command,
        geometry=load_geometry(folder / "geometry.vtp"),
        fractions=load_fractions(folder / "fractions.npz"),
        curves=pd.read_csv(folder / "plateaus.csv"),
        topologies=pd.read_csv(folder / "topologies.csv"),
        diagram=pd.read_csv(folder / "diagram.csv"),
        selection=Selection.from_dict(chosen),
        mesh=read_vtu(folder / "mesh.vtu", name=name),
        tables={table: pd.read_csv(folder / f"{table}.csv") for table in TABLES},
    )
