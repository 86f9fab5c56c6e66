"""Recompute what the record of a fit states, from the fitted mesh and the files in its folder."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd

from tusqh.certificate import FILE_NAME, read_certificate
from tusqh.files import path_of
from tusqh.fitting.distances import measure_distances
from tusqh.geometry.canonical import load_geometry
from tusqh.hashing import hash_file
from tusqh.meshes.checks import Check
from tusqh.meshes.export import read_vtu
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.pipeline.fit import find_target, load_fit
from tusqh.pipeline.original import Original
from tusqh.sampling.io import load_fractions
from tusqh.threshold.selection import load_selection

#: Largest difference of a recomputed distance, in cells.
_ROUNDING = 1e-6

#: Files without which distances are only those recorded.
_NEEDED = ("geometry", "fractions", "selection", "mesh")


def is_fitted(path: Path) -> bool:
    """Return whether a mesh file is the fitted mesh of its folder.

    Parameters
    ----------
    path
        The mesh file.

    Raises
    ------
    MeshError
        The record of a fit in its folder cannot be read.
    """
    record = path_of("fit", path.parent)
    return record.is_file() and load_fit(record)["fitted"]["file"] == path.name


def recheck_fit(path: Path, mesh: VolumeMesh) -> list[Check]:
    """Return the checks of a fitted mesh against its record, its staircase and the geometry.

    Digests, Betti numbers and distances are recomputed.  Without the geometry, the fractions or the
    staircase, the distances are those that the record states, and a row says so.

    Parameters
    ----------
    path
        The fitted mesh.
    mesh
        That mesh, as read.

    Raises
    ------
    MeshError
        The record cannot be read.
    """
    folder = path.parent
    record = load_fit(path_of("fit", folder))
    measured = mesh.measurement
    checks = [
        _same("mesh", "SHA-256 of the fitted mesh", hash_file(path), record["fitted"]["sha256"]),
        _same("euler", "Betti numbers", list(measured.by_euler), record["measured"]["euler"]),
    ]
    missing = [path_of(name, folder).name for name in _NEEDED if not path_of(name, folder).exists()]
    certificate = folder / FILE_NAME
    settings = read_certificate(certificate).get("settings") if certificate.is_file() else None
    if missing or settings is None:
        checks.append(
            Check(
                id="fit_distances",
                name="record of the fit: distances",
                found=f"not run: {' and '.join(missing) or FILE_NAME} is missing",
                required="as recorded",
                holds=None,
            )
        )
    else:
        checks += _from_geometry(folder, mesh, record, settings)
    return [*checks, *(Check(**check) for check in record["facts"]["comparison"])]


def _from_geometry(
    folder: Path, mesh: VolumeMesh, record: dict[str, Any], settings: dict[str, Any]
) -> list[Check]:
    """Return the checks of the staircase and of the distances, from the geometry."""
    staircase = path_of("mesh", folder)
    original = Original.from_dict(load_geometry(path_of("geometry", folder)), settings)
    fractions = load_fractions(path_of("fractions", folder))
    selection = load_selection(path_of("selection", folder))
    target = find_target(read_vtu(staircase), selection, fractions, original)
    found = measure_distances(mesh, target)
    stored = pd.DataFrame(record["all_distances"])
    numbers = ["mean", "p99", "max"]
    apart = (found[numbers].astype(float) - stored[numbers].astype(float)).abs()
    scale = found["unit"].map({"cells": 1.0, "model": fractions.grid.cell_size})
    n_other = int((apart.div(scale, axis=0) > _ROUNDING).to_numpy().sum())
    n_other += int((found[numbers].isna() != stored[numbers].isna()).to_numpy().sum())
    return [
        _same(
            "staircase", "SHA-256 of the staircase", hash_file(staircase), record["mesh"]["sha256"]
        ),
        Check(
            id="fit_distances",
            name="record of the fit: distances",
            found=f"{n_other} of {3 * len(found)} differ",
            required=f"0 of {3 * len(found)} differ",
            holds=n_other == 0,
        ),
    ]


def _same(key: str, name: str, found: Any, stored: Any) -> Check:
    """Return the check that a value is as the record states."""
    shown = [str(v)[:12] if isinstance(v, str) else str(v) for v in (found, stored)]
    return Check(
        id=f"fit_{key}",
        name=f"record of the fit: {name}",
        found=shown[0],
        required=shown[1],
        holds=found == stored,
    )
