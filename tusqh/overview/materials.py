"""Read the text and tables that the overview shows of a model of several materials."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from tusqh.files import path_of
from tusqh.overview.files_read import (
    FILES_READ_OF_MATERIALS,
    LINK_TITLES_OF_MATERIALS,
)
from tusqh.overview.model import ModelEntry, describe_source
from tusqh.quality.verdict import describe_contacts, overall


def read_materials_model(
    folder: Path,
    *,
    geometries: Sequence[str],
    figures: Sequence[Path] = (),
    links: Mapping[str, Path] | None = None,
    register: pd.DataFrame | None = None,
) -> ModelEntry:
    """Return the overview's entry for a model of several materials.

    Parameters
    ----------
    folder
        Folder of the model's results, with the files named in `FILES_READ_OF_MATERIALS`.
    geometries
        The geometry files, as named in the configuration.
    figures
        Pictures, in the order in which they are shown.
    links
        Other files to link to, by title; by default the files in `LINK_TITLES_OF_MATERIALS`.
    register
        The data register, if there is one.

    Raises
    ------
    FileNotFoundError
        A file is missing.
    """
    certificate = json.loads(path_of("certificate", folder).read_text("utf-8"))
    tables = {
        name: pd.read_csv(path_of(name, folder), dtype=dict.fromkeys(_NAMES, str))
        for name in FILES_READ_OF_MATERIALS[1:]
    }
    materials, verdict = tables["materials"], tables["verdict"]
    verification = tables["verification"]
    if links is None:
        links = {t: path_of(name, folder) for name, t in LINK_TITLES_OF_MATERIALS.items()}
    n_holding = int(verification["holds"].sum())
    return ModelEntry(
        name=certificate["model"],
        holds=not (verdict["holds"] == "no").any()
        and n_holding == len(verification)
        and bool(certificate["holds"]),
        is_warned=bool((verdict["holds"] == "warning").any()),
        lines=_describe(certificate, materials, verification)
        | {"verdict": overall(_grouped(verdict))},
        source=describe_source(certificate, geometries, register),
        tables={
            "Materials, and all of them together": _with_verdicts(materials, verdict),
            "Pairs of materials: overlaps, gaps and interfaces": tables["pairs"],
            "Checks of the mesh and of each material": verdict,
        },
        figures=figures,
        links=links,
    )


def _grouped(verdict: pd.DataFrame) -> pd.DataFrame:
    """Return the verdict with one row for a warning that more than `_FEW` materials have."""
    is_warned = (verdict["holds"] == "warning") & (verdict["material"] != "all")
    check = verdict["name"].str.rpartition(": ")[2]
    number = check[is_warned].map(check[is_warned].value_counts()).reindex(verdict.index).fillna(0)
    together = check + " of " + number.astype(int).astype(str) + " materials"
    grouped = verdict.assign(name=verdict["name"].mask(number > _FEW, together))
    return grouped[~(grouped.duplicated("name") & (number > _FEW))]


#: Warnings of up to so many materials name each of them.
_FEW = 3

#: Columns with names of materials, which may look like numbers.
_NAMES = ("material", "first", "second")


def _describe(
    certificate: Mapping[str, Any], materials: pd.DataFrame, verification: pd.DataFrame
) -> dict[str, str]:
    """Return what the page says of a model of several materials, by title."""
    alone = materials[materials["material"] != "all"]
    (whole,) = _to_records(verification[verification["material"] == "all"])
    (volume,) = _to_records(materials[materials["material"] == "all"])
    kind = "hexes" if whole["dimension"] == 3 else "quads"
    n_holding = int(alone["holds"].sum())
    betti = {how: _betti(certificate, how) for how in ("predicted", "measured")}
    return {
        "materials": f"{len(alone)}: {', '.join(alone['material'])}",
        "predicted": f"all together have the Betti numbers {betti['predicted']}",
        "measured": f"Betti numbers {betti['measured']} of all together, and {n_holding} of "
        f"{len(alone)} materials as predicted",
        "mesh": f"{volume['elements']:,} {kind} of {whole['grid']} cells, "
        f"{describe_contacts(whole)}, "
        f"volume {volume['volume'] / volume['volume_of_geometry']:.4f} of the volume fractions",
    }


def _to_records(table: pd.DataFrame) -> list[dict[str, Any]]:
    """Return the rows of a table, each by the names of its columns."""
    return [{str(k): value for k, value in row.items()} for row in table.to_dict("records")]


def _betti(certificate: Mapping[str, Any], how: str) -> tuple[int, ...]:
    """Return the predicted or measured Betti numbers of all materials together."""
    found = certificate[how]["all"]
    return tuple(found if how == "predicted" else found["euler"])


def _with_verdicts(materials: pd.DataFrame, verdict: pd.DataFrame) -> pd.DataFrame:
    """Return the table of materials with the verdict on each; that on all includes everything."""
    shown = materials[["material", "threshold", "elements", "volume", "volume_of_geometry"]].copy()
    for how in ("predicted", "measured"):
        betti = materials[[f"betti_{k}_{how}" for k in range(3)]].to_numpy().tolist()
        shown[f"Betti numbers {how}"] = [str(tuple(row)) for row in betti]
    shown["min_scaled_jacobian"] = materials["min_scaled_jacobian"]
    verdicts = [
        overall(verdict if name == "all" else verdict[verdict["material"] == name])
        for name in materials["material"]
    ]
    return shown.assign(verdict=verdicts)
