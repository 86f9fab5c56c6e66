"""Read the text and tables that the overview shows of one model from its results."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pandas as pd

from tusqh.files import path_of
from tusqh.geometry.packaged import locate
from tusqh.geometry.remark import Remark
from tusqh.hashing import hash_file
from tusqh.overview.files_read import FILES_READ, LINK_TITLES, LINK_TITLES_OF_FIT
from tusqh.pipeline.describe_reading import lines_of_reading
from tusqh.pipeline.fit import read_facts
from tusqh.quality.fit_checks import describe_fit
from tusqh.quality.verdict import compare_volumes, describe_changes, describe_contacts, overall
from tusqh.threshold.within_interval import describe_extent

#: Columns of the register that describe the origin of a geometry.
_ORIGIN = ("origin", "licence", "url", "known_defects")


@dataclass(frozen=True)
class ModelEntry:
    """A model as shown in the overview, with plain values and tables only.

    Parameters
    ----------
    name
        Name of the model.
    holds
        Whether the mesh has the predicted topology at every threshold and no check fails.
    is_warned
        Whether a check warns.
    lines
        Wanted, predicted, selected and measured topology, size and verdict, by title.
    source
        Provenance of the geometry: file, SHA-256, origin, licence.
    tables
        Defects, candidates, verification and verdict, by title.
    figures
        Pictures, in the order in which they are shown.
    links
        Other files to link to, by title.
    """

    name: str
    holds: bool
    is_warned: bool
    lines: dict[str, str]
    source: dict[str, str]
    tables: dict[str, pd.DataFrame]
    figures: Sequence[Path] = ()
    links: Mapping[str, Path] = field(default_factory=dict)


def read_model(
    folder: Path,
    *,
    geometry: str,
    figures: Sequence[Path] = (),
    links: Mapping[str, Path] | None = None,
    register: pd.DataFrame | None = None,
    fitted: bool = False,
) -> ModelEntry:
    """Return the overview's entry for a model.

    Parameters
    ----------
    folder
        Folder of the model's results, with the files named in `FILES_READ`.
    geometry
        The geometry, as named in the configuration.
    figures
        Pictures, in the order in which they are shown.
    links
        Other files to link to, by title; by default the files in `LINK_TITLES`.
    register
        The data register, if there is one.
    fitted
        Whether its mesh is fitted.

    Returns
    -------
    ModelEntry
        Text and tables for the page.

    Raises
    ------
    FileNotFoundError
        A file named in `FILES_READ` is missing.
    """
    certificate = json.loads(path_of("certificate", folder).read_text("utf-8"))
    facts = read_facts(path_of("facts", folder), path_of("fit", folder) if fitted else None)
    reading = json.loads(path_of("reading", folder).read_text("utf-8"))
    tables = {name: pd.read_csv(path_of(name, folder)) for name in FILES_READ[3:]}
    verdict, verification = tables["verdict"], tables["verification"]
    if links is None:
        titles = LINK_TITLES | (LINK_TITLES_OF_FIT if fitted else {})
        links = {title: path_of(name, folder) for name, title in titles.items()}
    chosen, measured = certificate["selection"], certificate["measured"]["euler"]
    n_holding = int(verification["holds"].sum())
    is_suitable = not (verdict["holds"] == "no").any()
    kind = "hexes" if facts["dimension"] == 3 else "quads"
    lines = _describe_reading(reading) | {
        "wanted": chosen["wanted"],
        "predicted": f"Betti numbers {tuple(certificate['predicted']['effective'])}",
        "threshold": f"{chosen['threshold']:.6g}: "
        + describe_extent(
            (chosen["lower"], chosen["upper"]), (chosen["cells_lower"], chosen["cells_upper"])
        )
        + f"; {chosen['reason']}",
        "measured": f"Betti numbers {tuple(measured)}",
        "mesh": f"{facts['elements']:,} {kind} of {facts['grid']} cells, "
        f"{describe_contacts(facts)}, "
        f"volume {compare_volumes(facts)}",
        **describe_fit(facts),
        **describe_changes(facts),
        "verdict": overall(verdict),
        "every threshold": f"{n_holding} of {len(verification)} as predicted",
    }
    return ModelEntry(
        name=certificate["model"],
        holds=is_suitable and n_holding == len(verification) and bool(certificate["holds"]),
        is_warned=bool((verdict["holds"] == "warning").any()),
        lines=lines,
        source=describe_source(certificate, [geometry], register),
        tables={
            "Defects of the geometry": tables["defects"],
            "Intervals with the wanted topology": tables["candidates"],
            "Predicted and measured at every threshold": verification,
            "Checks of the mesh": verdict.drop(columns="material", errors="ignore"),
        },
        figures=figures,
        links=links,
    )


def _describe_reading(reading: dict[str, Any]) -> dict[str, str]:
    """Return the description of the reading, and the remarks on it."""
    remarks = "; ".join(str(Remark(**remark)) for remark in reading["remarks"])
    return lines_of_reading(reading) | ({"remarks": remarks} if remarks else {})


def describe_source(
    certificate: Mapping[str, Any], geometries: Sequence[str], register: pd.DataFrame | None
) -> dict[str, str]:
    """Return the origin of a model's geometry, and the digests of its fractions and mesh.

    Parameters
    ----------
    certificate
        The certificate of the model.
    geometries
        Its geometry files, as named in the configuration.
    register
        The data register, if there is one.
    """
    source: dict[str, str] = {}
    for geometry in geometries:
        title = "geometry" if len(geometries) == 1 else f"geometry {Path(geometry).name}"
        digest = hash_file(locate(geometry))
        source |= {title: geometry, f"SHA-256 of the {title}": digest}
    if register is not None:
        for row in register[register["model"] == certificate["model"]].to_dict("records"):
            source |= {"SHA-256 in the register": str(row["sha256"])}
            titles = {key: key.replace("_", " ") for key in _ORIGIN}
            source |= {titles[key]: str(row[key]) for key in _ORIGIN if pd.notna(row[key])}
    source |= {
        f"SHA-256 of {certificate[key]['file']}": certificate[key]["sha256"]
        for key in ("fractions", "mesh")
    }
    return source | {"made by": f"tusqh {certificate['tusqh']}"}
