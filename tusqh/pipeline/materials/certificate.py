"""Make and read the certificate of a mesh of several materials.

`tusqh.pipeline.materials.recheck` recomputes it.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np

from tusqh import __version__
from tusqh.contacts import MaterialMesh, mesh_materials
from tusqh.contacts.fractions_file import load_materials
from tusqh.contacts.material_fractions import ALL
from tusqh.errors import MeshError
from tusqh.files import path_of
from tusqh.hashing import hash_file
from tusqh.local_topology.local_labels import MaterialWish, label_locally
from tusqh.meshes.export import read_regions, read_vtu
from tusqh.meshes.measure_regions import RegionMeasurement
from tusqh.meshes.regions import Regions
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.pipeline.materials.judge import (
    compare_volumes,
    judge_materials,
    measure_materials,
    volumes_of_geometry,
)
from tusqh.pipeline.materials.original import MaterialsOriginal
from tusqh.pipeline.original import to_warnings
from tusqh.topology.betti_numbers import BettiNumbers

#: Version of certificates of several materials; those of one material have whole numbers.
VERSION = "materials 2"


def make_certificate(
    folder: Path,
    thresholds: Mapping[str, float],
    *,
    name: str,
    volume_tolerance: float,
    original: MaterialsOriginal | None = None,
    base: Mapping[str, float] | None = None,
    wishes: Sequence[MaterialWish] = (),
) -> dict[str, Any]:
    """Return the certificate of a mesh, from its files as they were written.

    Parameters
    ----------
    folder
        Folder with the mesh, the fractions and, where there is an original, the geometry.
    thresholds
        Threshold of every material by name.
    name
        The model.
    volume_tolerance
        Largest relative difference between volumes that causes no warning.
    original
        The geometries; None: the fractions were given.
    base
        With the local scope: the threshold of every material at the base.
    wishes
        What was done about single features.

    Returns
    -------
    certificate
        See `tusqh/certificate_of_materials.schema.json`.
    """
    mesh, regions = read_materials(path_of("mesh", folder))
    measured = measure_materials(mesh, regions)
    fractions = load_materials(path_of("fractions", folder))
    local = None if base is None else label_locally(fractions, thresholds, base, wishes)
    labels = None if local is None else local.labels
    built = mesh_materials(fractions, thresholds=thresholds, labels=labels)
    predicted = predict(built)
    volumes = volumes_of_geometry(fractions)
    certificate = {
        "certificate": VERSION,
        "model": name,
        "tusqh": __version__,
        "mesh": _digest(path_of("mesh", folder)),
        "fractions": _digest(path_of("fractions", folder)),
        "thresholds": dict(thresholds),
        "volume_tolerance": volume_tolerance,
        **claims_of_fractions(built),
        **claims_of_mesh(mesh, measured, predicted),
        "warnings": to_warnings(compare_volumes(measured, volumes, volume_tolerance)),
    }
    if base is not None and local is not None:
        certificate["base"] = dict(base)
        certificate["features"] = [wish._asdict() for wish in wishes]
        certificate["changed_cells"] = local.n_changes
    if original is not None:
        certificate["geometry"] = _digest(path_of("geometry", folder))
        certificate["settings"] = original.to_dict()
    jsonschema.validate(certificate, materials_schema())
    return certificate


def claims_of_mesh(
    mesh: VolumeMesh,
    measured: Mapping[str, RegionMeasurement],
    predicted: Mapping[str, BettiNumbers],
) -> dict[str, Any]:
    """Return the claims of a certificate about the mesh alone.

    Parameters
    ----------
    mesh
        The mesh.
    measured
        See `tusqh.pipeline.materials.judge.measure_materials`.
    predicted
        Betti numbers that every material and all together must have.
    """
    checks = judge_materials(mesh, measured, predicted)
    return {
        "measured": {
            name: {
                "euler": list(found.by_euler),
                "boundary": list(found.by_boundary),
                "non_manifold_points": found.n_non_manifold,
                "elements": found.n_cells,
            }
            for name, found in measured.items()
        },
        "holds": all(check.holds for check in checks),
    }


def claims_of_fractions(built: MaterialMesh) -> dict[str, Any]:
    """Return the claims of a certificate about the fractions, before meshing.

    Parameters
    ----------
    built
        What `tusqh.contacts.mesh_materials` makes of the fractions.
    """
    return {
        "predicted": {name: list(betti) for name, betti in predict(built).items()},
        "contacts": {"decided": built.n_contacts, "overruled": built.n_overruled},
    }


def predict(built: MaterialMesh) -> dict[str, BettiNumbers]:
    """Return the predicted Betti numbers of materials with elements, and of all together.

    Parameters
    ----------
    built
        What `tusqh.contacts.mesh_materials` made.
    """
    present = {built.names[k] for k in np.unique(built.material).tolist()}
    return {
        **{name: betti for name, betti in built.predicted.items() if name in present},
        ALL: built.predicted_solid,
    }


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


def materials_schema() -> dict[str, Any]:
    """Return the JSON schema of certificates of several materials."""
    path = resources.files("tusqh").joinpath("certificate_of_materials.schema.json")
    return dict(json.loads(path.read_text("utf-8")))


def read_certificate(path: Path) -> dict[str, Any]:
    """Return a certificate of several materials.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    MeshError
        It cannot be read or does not follow the schema.
    """
    try:
        stored = json.loads(path.read_text("utf-8"))
        jsonschema.validate(stored, materials_schema())
    except (OSError, ValueError, jsonschema.ValidationError) as reason:
        text = reason.message if isinstance(reason, jsonschema.ValidationError) else str(reason)
        raise MeshError(
            f"is not a valid certificate of several materials: {text}",
            where=str(path),
            expected="a file that was written together with the mesh, unchanged",
            remedy="mesh the materials again, or check the mesh in another folder without "
            "certificate",
        ) from reason
    return dict(stored)


def _digest(path: Path) -> dict[str, str]:
    return {"file": path.name, "sha256": hash_file(path)}
