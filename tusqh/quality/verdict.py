"""The verdict of analysis suitability: one row per check, with what was found and required."""

from __future__ import annotations

import math
from collections.abc import Callable

import pandas as pd

from tusqh.errors import TusqhError
from tusqh.extras import MissingExtraError
from tusqh.meshes.betti import betti_by_boundary, betti_by_euler
from tusqh.meshes.checks import Check, check_mesh
from tusqh.meshes.jacobians import corner_jacobians, element_volumes, enclosed_volume
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.quality.surface import measure_overlap, surface_measures
from tusqh.quality.system_libraries import SystemLibraryError
from tusqh.simulate.components import count_matrix_components
from tusqh.topology.betti_numbers import BettiNumbers

#: Smallest scaled Jacobian that the templates can make: the trapezoids of the 1-5 template on
#: square cells, the frusta of the 1-7 template on cubic ones.
SCALED_JACOBIAN = {2: math.sqrt(2) / 2, 3: 1 / math.sqrt(3)}

#: Room for rounding in coordinates of 1e7 times the cell size.
_ROUNDING = 1e-8


def judge_mesh(
    mesh: VolumeMesh, predicted: BettiNumbers, element_metrics: pd.DataFrame | None
) -> list[Check]:
    """Return every check of a mesh, by our own count, VTK, pymeshlab and MFEM.

    Parameters
    ----------
    mesh
        The mesh.
    predicted
        Betti numbers it must have.
    element_metrics
        VTK's metrics, see `tusqh.quality.elements.element_metrics`;
        None where VTK is not installed.
    """
    checks = check_mesh(mesh)
    if not all(check.holds for check in checks):
        return checks
    checks += [
        _equal("Betti numbers by Euler characteristic", betti_by_euler(mesh), predicted),
        _equal("Betti numbers by boundary", betti_by_boundary(mesh), predicted),
        _at_least(
            "smallest scaled Jacobian",
            float(corner_jacobians(mesh.points, mesh.cells)[1].min()),
            SCALED_JACOBIAN[mesh.dim],
        ),
        _vtk_jacobian(element_metrics, SCALED_JACOBIAN[mesh.dim]),
        _overlap(mesh),
        _matrix_components(mesh, predicted),
    ]
    return checks + judge_surface(mesh, predicted)


def judge_surface(
    mesh: VolumeMesh,
    predicted: BettiNumbers,
    measure: Callable[[VolumeMesh], object] = surface_measures,
) -> list[Check]:
    """Return pymeshlab's view of the mesh as a surface; "not run" where it cannot be had."""
    required = {
        "non_manifold_edges": 0,
        "non_manifold_vertices": 0,
        "self_intersecting_faces": 0,
        "unreferenced_vertices": 0,
        "connected_components": predicted.betti_0 + predicted.betti_2,
        "boundary_loops": predicted.betti_0 + predicted.betti_1,
    }
    if mesh.dim == 3:  # The boundary of a volume is closed, and its handles are the holes.
        required |= {"boundary_loops": 0, "genus": predicted.betti_1}
    names = {key: f"{key.replace('_', ' ')} (pymeshlab)" for key in required}
    try:
        measures = measure(mesh)
    except (MissingExtraError, SystemLibraryError) as reason:
        return [
            Check(names[key], _not_run(reason), str(value), None) for key, value in required.items()
        ]
    return [_equal(names[key], getattr(measures, key), value) for key, value in required.items()]


def to_table(checks: list[Check]) -> pd.DataFrame:
    """Return checks as a table: name, found, required, holds (yes, no or not run)."""
    words = {True: "yes", False: "no", None: "not run"}
    return pd.DataFrame(
        [(c.name, str(c.found), c.required, words[c.holds]) for c in checks],
        columns=["name", "found", "required", "holds"],
    )


def overall(checks: pd.DataFrame) -> str:
    """Return the verdict over a table of checks: suitable, or how many checks fail or did not run.

    Examples
    --------
    >>> overall(to_table([Check("a", 0, "0", True), Check("b", 1, "0", False)]))
    'not suitable: 1 check fails'
    """
    n_failed = int((checks["holds"] == "no").sum())
    n_missing = int((checks["holds"] == "not run").sum())
    if n_failed:
        return f"not suitable: {n_failed} check{'s' if n_failed > 1 else ''} " + (
            "fail" if n_failed > 1 else "fails"
        )
    return f"suitable ({n_missing} not run)" if n_missing else "suitable"


def _vtk_jacobian(metrics: pd.DataFrame | None, bound: float) -> Check:
    name = "smallest scaled Jacobian by VTK"
    if metrics is None:
        return Check(name, "not run: VTK is not installed", f">= {bound:.6f}", None)
    return _at_least(name, float(metrics["scaled_jacobian"].min(skipna=False)), bound)


def _matrix_components(mesh: VolumeMesh, predicted: BettiNumbers) -> Check:
    name = "components of MFEM's matrix"
    try:
        return _equal(name, count_matrix_components(mesh), predicted.betti_0)
    except MissingExtraError as reason:
        return Check(name, _not_run(reason), str(predicted.betti_0), None)
    except TusqhError as reason:
        return _equal(name, f"rejected: {reason.found}", predicted.betti_0)


def _not_run(reason: TusqhError) -> str:
    if isinstance(reason, MissingExtraError):
        return f"not run: {reason.where} is not installed"
    return f"not run: {reason.found}"


def _overlap(mesh: VolumeMesh) -> Check:
    """Check that elements do not overlap; in 3D the boundary must enclose as much as they fill."""
    if mesh.dim == 2:
        return _at_most("share of the area covered twice", measure_overlap(mesh), 1e-9)
    filled = float(element_volumes(mesh.points, mesh.cells).sum())
    share = abs(enclosed_volume(mesh) / filled - 1)
    return _at_most("enclosed and filled volume, relative difference", share, 1e-9)


def _equal(name: str, found: object, required: object) -> Check:
    return Check(name, found, str(required), found == required)


def _at_least(name: str, found: float, required: float) -> Check:
    return Check(name, f"{found:.6f}", f">= {required:.6f}", found >= required - _ROUNDING)


def _at_most(name: str, found: float, required: float) -> Check:
    return Check(name, f"{found:.1e}", f"<= {required:g}", found <= required)
