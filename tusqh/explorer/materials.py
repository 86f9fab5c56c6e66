"""Make the explorer page of a mesh of several materials.

It shows the mesh, coloured by material; each material can be hidden.  Each has a threshold of its
own against the others, so that no single threshold can be moved.  Classes of each material can be
opened, cut and filled.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from tusqh.contacts.fractions_file import load_materials
from tusqh.contacts.material_fractions import MaterialFractions
from tusqh.explorer.arrays import CUT_ELEMENTS, mesh_arrays
from tusqh.explorer.assets import SCRIPTS_OF_MATERIALS, TEMPLATE_OF_MATERIALS, read_script
from tusqh.explorer.changes import offer_material_wishes
from tusqh.explorer.command import materials_command
from tusqh.explorer.encode import pack
from tusqh.explorer.files_read import FILES_OF_MATERIALS, TABLES_OF_MATERIALS
from tusqh.explorer.page import assemble, to_rows
from tusqh.explorer.subject import MeshSubject, find_files
from tusqh.figures.material_colours import colours_of
from tusqh.figures.units import length_scale
from tusqh.files import path_of
from tusqh.geometry.units import ASSUMED
from tusqh.geometry.upright import Axis
from tusqh.grid import BackgroundGrid
from tusqh.meshes.interfaces import find_junction_edges
from tusqh.meshes.regions import Regions
from tusqh.pipeline.materials.certificate import read_materials
from tusqh.quality.verdict import overall


@dataclass(frozen=True, kw_only=True)
class MaterialsSubject(MeshSubject):
    """A model of several materials, with the tables named in `TABLES_OF_MATERIALS`.

    Parameters
    ----------
    name, unit, up, command, mesh, tables
        See `tusqh.explorer.subject.MeshSubject`.
    fractions
        Fractions of all materials.
    base
        Threshold of every material at the base, by name.
    regions
        The material of every element.
    """

    fractions: MaterialFractions
    base: Mapping[str, float]
    regions: Regions

    @property
    def grid(self) -> BackgroundGrid:
        """The background grid."""
        return self.fractions.grid


def has_materials(folder: Path) -> bool:
    """Return whether a folder has the results of a model of several materials.

    Parameters
    ----------
    folder
        The folder.
    """
    return path_of("materials", folder).is_file()


def read_materials_subject(
    folder: Path, *, geometry: str | None = None, up: Axis = "z"
) -> MaterialsSubject:
    """Return the subject in a result folder, which has the model's name.

    Parameters
    ----------
    folder
        The folder.
    geometry
        The first geometry file, for the command; None: the name that the folder records.
    up
        Axis that points up.

    Raises
    ------
    ConfigError
        Files are missing from the folder.
    """
    paths = find_files(
        folder, FILES_OF_MATERIALS, what="a model of several materials", option="--materials"
    )
    name = folder.resolve().name
    mesh, regions = read_materials(paths["mesh"])
    names = dict.fromkeys(("material", "first", "second"), str)
    stored: dict[str, Any] = json.loads(paths["certificate"].read_text(encoding="utf-8"))
    fractions = load_materials(paths["fractions"])
    return MaterialsSubject(
        name=name,
        unit=mesh.unit or ASSUMED,
        up=up,
        command=materials_command(stored, fractions.grid, geometry or f"{name}.stl", name=name),
        fractions=fractions,
        base=stored.get("base", stored["thresholds"]),
        mesh=replace(mesh, name=name),
        regions=regions,
        tables={table: pd.read_csv(paths[table], dtype=names) for table in TABLES_OF_MATERIALS},
    )


def make_materials_page(subject: MaterialsSubject) -> str:
    """Return the page of a model of several materials; the same subject gives the same text.

    Parameters
    ----------
    subject
        A model with its results.
    """
    regions = subject.regions
    arrays = mesh_arrays(subject.mesh, subject.grid, regions.material)
    cells, facts = offer_material_wishes(subject.fractions, subject.base)
    script = read_script(SCRIPTS_OF_MATERIALS)
    return assemble(
        TEMPLATE_OF_MATERIALS,
        subject.name,
        describe_materials(subject) | facts,
        {"mesh": pack(arrays | _curves(subject)), "wishes": pack(cells)},
        script=script,
    )


def _curves(subject: MaterialsSubject) -> dict[str, Any]:
    """Return the edges at which three materials meet, the outside among them, as `curves`."""
    mesh, material = subject.mesh, subject.regions.material
    edges = find_junction_edges(mesh, material) if mesh.dim == 3 else np.empty((0, 2))
    return {"curves": edges.astype(np.uint32)}


def describe_materials(subject: MaterialsSubject) -> dict[str, Any]:
    """Return the texts and tables of the page, as plain values for JSON.

    Parameters
    ----------
    subject
        A model with its results.
    """
    grid, mesh, regions, tables = subject.grid, subject.mesh, subject.regions, subject.tables
    counts = np.bincount(regions.material, minlength=len(regions.names)).tolist()
    colours = colours_of(regions.names)
    whole = tables["materials"]["material"] == "all"
    kind = "hexes" if grid.dim == 3 else "quads"
    (betti,) = _betti(tables["materials"][whole], "measured")
    return {
        "name": subject.name,
        "unit": subject.unit,
        "up": subject.up,
        "grid": grid.to_dict(),
        "verdict": overall(tables["verdict"]),
        "command": asdict(subject.command),
        "can_cut": mesh.n_cells <= CUT_ELEMENTS,
        "materials": [
            {"name": name, "colour": colour, "count": count}
            for name, colour, count in zip(regions.names, colours, counts, strict=True)
        ],
        "head": [
            ["grid", f"{grid.label.replace('x', ' × ')} cells"],
            ["cell size", f"{grid.cell_size:.6g} {subject.unit}"],
            ["materials", str(len(regions.present))],
            ["mesh", f"{mesh.n_cells:,} {kind}"],
            ["Betti numbers of all together", betti],
        ],
        "tables": {
            "materials": to_rows(_shown(subject)),
            "pairs": to_rows(tables["pairs"]),
            "elements": to_rows(tables["elements"]),
            "verdict": to_rows(tables["verdict"].drop(columns=["id", "material"])),
        },
    }


def _shown(subject: MaterialsSubject) -> pd.DataFrame:
    """Return the table of materials as the page shows it."""
    table, verdict = subject.tables["materials"], subject.tables["verdict"]
    grid = subject.grid
    scale, unit = length_scale(grid.cell_size * max(grid.shape), subject.unit)
    size = f"volume [{unit}³]" if grid.dim == 3 else f"area [{unit}²]"
    return pd.DataFrame(
        {
            "material": table["material"],
            "predicted": _betti(table, "predicted"),
            "measured": _betti(table, "measured"),
            "elements": table["elements"],
            size: table["volume"] / scale**grid.dim,
            "of geometry": table["volume"] / table["volume_of_geometry"],
            "threshold": table["threshold"],
            "verdict": [
                overall(verdict if name == "all" else verdict[verdict["material"] == name])
                for name in table["material"]
            ],
        }
    )


def _betti(table: pd.DataFrame, how: str) -> list[str]:
    """Return Betti numbers of materials as texts."""
    rows = table[[f"betti_{k}_{how}" for k in range(3)]].to_numpy().tolist()
    return [", ".join(str(int(n)) for n in row) for row in rows]
