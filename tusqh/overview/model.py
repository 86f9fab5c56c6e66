"""What the overview says about one model, read from the files of its folder."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from tusqh.geometry.packaged import locate
from tusqh.hashing import hash_file
from tusqh.pipeline.result import count_pinches
from tusqh.quality.verdict import overall

#: Columns of the register that say where a geometry comes from.
_ORIGIN = ("origin", "licence", "url", "known_defects")

Rows = list[dict[str, Any]]


@dataclass(frozen=True)
class ModelFiles:
    """The files of a model.

    Parameters
    ----------
    geometry
        The geometry, as the configuration names it.
    certificate, facts, defects, candidates, verdict, verification
        What the steps of the workflow wrote.
    figures
        Pictures, in the order in which they are shown.
    links
        Other files to link to, by title.
    """

    geometry: str
    certificate: Path
    facts: Path
    defects: Path
    candidates: Path
    verdict: Path
    verification: Path
    figures: Sequence[Path] = ()
    links: Mapping[str, Path] | None = None


@dataclass(frozen=True)
class ModelEntry:
    """A model as the overview shows it: plain values and tables only.

    Parameters
    ----------
    name
        The model.
    holds
        Whether the mesh measures what was predicted at every threshold, and no check fails.
    lines
        Wanted, predicted, chosen, measured and so on, by title.
    source
        Where the geometry comes from: file, SHA-256, origin, licence.
    tables
        Defects, candidates, verification and verdict, by title.
    figures, links
        See `ModelFiles`.
    """

    name: str
    holds: bool
    lines: dict[str, str]
    source: dict[str, str]
    tables: dict[str, pd.DataFrame]
    figures: Sequence[Path]
    links: Mapping[str, Path]


def read_model(files: ModelFiles, register: pd.DataFrame | None = None) -> ModelEntry:
    """Return what the overview says about a model.

    Parameters
    ----------
    files
        The files of the model.
    register
        The data register, where there is one.
    """
    certificate = json.loads(files.certificate.read_text("utf-8"))
    facts = json.loads(files.facts.read_text("utf-8"))
    verdict, verification = pd.read_csv(files.verdict), pd.read_csv(files.verification)
    chosen, measured = certificate["selection"], certificate["measured"]["euler"]
    n_holding = int(verification["holds"].sum())
    is_suitable = not (verdict["holds"] == "no").any()
    kind = "hexes" if facts["dimension"] == 3 else "quads"
    lines = {
        "wanted": chosen["wanted"],
        "predicted": f"Betti numbers {tuple(certificate['predicted']['effective'])}",
        "threshold": f"{chosen['threshold']:.6g}, holds within ±{chosen['margin']:.3g}: "
        + chosen["reason"],
        "measured": f"Betti numbers {tuple(measured)}",
        "mesh": f"{facts['elements']:,} {kind} of {facts['grid']} cells, "
        f"{count_pinches(facts['pinches'])}, volume "
        f"{facts['volume'] / facts['winding_volume']:.4f} of the winding-number volume",
        "verdict": overall(verdict),
        "every threshold": f"{n_holding} of {len(verification)} as predicted",
    }
    return ModelEntry(
        name=certificate["model"],
        holds=is_suitable and n_holding == len(verification) and bool(certificate["holds"]),
        lines=lines,
        source=_describe_source(certificate, files.geometry, register),
        tables={
            "Defects of the geometry": pd.read_csv(files.defects),
            "Intervals with what was wanted": pd.read_csv(files.candidates),
            "Predicted and measured at every threshold": verification,
            "Checks of the mesh": verdict,
        },
        figures=files.figures,
        links=files.links or {},
    )


def _describe_source(
    certificate: dict[str, Any], geometry: str, register: pd.DataFrame | None
) -> dict[str, str]:
    """Return where a model comes from, and the digests of what was made of it."""
    source = {"geometry": geometry, "SHA-256 of the geometry": hash_file(locate(geometry))}
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
