"""Make the certificate of a mesh of several materials, and check it from the files alone."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pandas as pd

from tusqh import __version__
from tusqh.certificate import FILE_NAME
from tusqh.contacts import MaterialFractions, mesh_materials
from tusqh.contacts.fractions_file import load_materials
from tusqh.errors import MeshError
from tusqh.hashing import hash_file
from tusqh.meshes.checks import Check
from tusqh.meshes.export import read_regions, read_vtu
from tusqh.meshes.measure_regions import RegionMeasurement
from tusqh.meshes.regions import Regions
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.pipeline.materials.judge import ALL, judge_all, judge_materials, measure_materials
from tusqh.topology.betti_numbers import BettiNumbers

#: Version of certificates of several materials; those of one material have whole numbers.
VERSION = "materials 1"


def make_certificate(
    mesh_file: Path, fractions_file: Path, thresholds: Mapping[str, float], *, name: str
) -> dict[str, Any]:
    """Return the certificate of a mesh, from its files as they were written.

    Parameters
    ----------
    mesh_file, fractions_file
        The mesh and the fractions it was made of, in one folder.
    thresholds
        Threshold of every material by name.
    name
        The model.

    Returns
    -------
    certificate
        Digests of both files, and for every material and all together the threshold, the predicted
        and the measured Betti numbers, and whether they agree.
    """
    mesh, regions = read_materials(mesh_file)
    measured = measure_materials(mesh, regions)
    predicted = _predict(load_materials(fractions_file), thresholds)
    checks = judge_materials(mesh, measured, predicted)
    return {
        "certificate": VERSION,
        "model": name,
        "tusqh": __version__,
        "mesh": {"file": mesh_file.name, "sha256": hash_file(mesh_file)},
        "fractions": {"file": fractions_file.name, "sha256": hash_file(fractions_file)},
        "thresholds": dict(thresholds),
        "predicted": {name: list(betti) for name, betti in predicted.items()},
        "measured": _measured(measured),
        "holds": all(check.holds for check in checks),
    }


def check_materials(mesh_file: Path, *, checks: Literal["all"] | None = None) -> pd.DataFrame:
    """Return the checks of a mesh file of several materials, and of the certificate beside it.

    Parameters
    ----------
    mesh_file
        A VTU file with materials.
    checks
        Whether other programs check large meshes too, see `tusqh.settings.quality.Quality`.

    Returns
    -------
    verdict
        One row per check, see `tusqh.quality.verdict.to_table`.

    Raises
    ------
    MeshError
        The mesh or its certificate cannot be read.
    """
    mesh, regions = read_materials(mesh_file)
    measured = measure_materials(mesh, regions)
    path = mesh_file.parent / FILE_NAME
    if not path.is_file():
        return judge_all(mesh, regions, measured, checks=checks).verdict
    stored = _read(path)
    predicted = {name: BettiNumbers(*betti) for name, betti in stored["predicted"].items()}
    recomputed = {
        "mesh": hash_file(mesh_file),
        "measured": _measured(measured),
        "holds": all(check.holds for check in judge_materials(mesh, measured, predicted)),
    }
    fractions_file = path.parent / stored["fractions"]["file"]
    if fractions_file.is_file():
        again = _predict(load_materials(fractions_file), stored["thresholds"])
        recomputed["fractions"] = hash_file(fractions_file)
        recomputed["predicted"] = {name: list(betti) for name, betti in again.items()}
    claimed = {**stored, **{key: stored[key]["sha256"] for key in ("mesh", "fractions")}}
    claims = [_compare(key, value, claimed[key]) for key, value in recomputed.items()]
    found = judge_all(mesh, regions, measured, predicted, comparison=claims, checks=checks)
    return found.verdict


def read_materials(mesh_file: Path) -> tuple[VolumeMesh, Regions]:
    """Return a mesh and its materials from a VTU file.

    Parameters
    ----------
    mesh_file
        The file.

    Returns
    -------
    mesh, regions
        The mesh, and the material of every element.

    Raises
    ------
    MeshError
        The file has no materials.
    """
    regions = read_regions(mesh_file)
    if regions is None:
        raise MeshError(
            "has no materials",
            where=str(mesh_file),
            expected="cell data `material`, and the number of each name as field data",
            remedy="write the mesh with `tusqh mesh --materials`",
        )
    return read_vtu(mesh_file), regions


def _predict(
    fractions: MaterialFractions, thresholds: Mapping[str, float]
) -> dict[str, BettiNumbers]:
    """Return the predicted Betti numbers of every material that has any, and of all together."""
    found = mesh_materials(fractions, thresholds=thresholds)
    present = {fractions.names[k] for k in np.unique(found.material).tolist()}
    return {
        **{name: betti for name, betti in found.predicted.items() if name in present},
        ALL: found.predicted_solid,
    }


def _measured(measured: Mapping[str, RegionMeasurement]) -> dict[str, Any]:
    """Return the measured Betti numbers of materials as plain values."""
    return {
        name: {"euler": list(found.by_euler), "boundary": list(found.by_boundary)}
        for name, found in measured.items()
    }


def _read(path: Path) -> dict[str, Any]:
    """Return a certificate of several materials."""
    try:
        stored = dict(json.loads(path.read_text("utf-8")))
    except (OSError, ValueError, TypeError) as reason:
        raise _invalid(path, str(reason)) from reason
    missing = {"predicted", "measured", "thresholds", "mesh", "fractions", "holds"} - set(stored)
    if stored.get("certificate") != VERSION or missing:
        raise _invalid(path, "it is not the certificate of several materials")
    return stored


def _invalid(path: Path, why: str) -> MeshError:
    return MeshError(
        f"is not a valid certificate: {why}",
        where=str(path),
        expected="a file that was written together with the mesh, unchanged",
        remedy="mesh the materials again, or check the mesh in another folder without certificate",
    )


def _compare(key: str, found: Any, claimed: Any) -> Check:
    """Return the check of one claim."""
    is_same = found == claimed
    return Check(
        id=f"certificate_{key}",
        name=f"certificate: {key}",
        found="as recorded" if is_same else f"not as recorded: {str(found)[:60]}",
        required="as recorded",
        holds=is_same,
    )
