"""Judge the analysis suitability of a mesh, with one row for each check."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from tusqh.antialias.scheme import PINCH_TEMPLATES, Scheme
from tusqh.errors import TusqhError
from tusqh.extras import MissingExtraError
from tusqh.meshes.checks import Check
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.quality.overlap import measure_overlap
from tusqh.quality.surface import judge_surface
from tusqh.simulate.components import count_matrix_components
from tusqh.topology.betti_numbers import BettiNumbers

#: Programs that give a second opinion.
_OTHERS = ("VTK", "MFEM", "pymeshlab")

#: Largest share of the area or volume that may be covered twice.
_OVERLAP = 1e-9


def judge_mesh(
    mesh: VolumeMesh,
    predicted: BettiNumbers,
    element_metrics: pd.DataFrame | None,
    *,
    scheme: Scheme = PINCH_TEMPLATES,
) -> list[Check]:
    """Return all checks of a mesh, by our own counts, VTK, pymeshlab and MFEM.

    Parameters
    ----------
    mesh
        The mesh.
    predicted
        Betti numbers it must have.
    element_metrics
        VTK's metrics, see `tusqh.quality.elements.element_metrics`;
        None if VTK is not installed.
    scheme
        The meshing scheme, which bounds the scaled Jacobians of the elements.

    Returns
    -------
    checks
        The checks of `tusqh.meshes.measure.Measurement`, followed by the others if all of these
        hold.
    """
    own = judge_alone(mesh, predicted, scheme=scheme)
    if not mesh.measurement.is_sound:
        return own
    return [*own, *judge_by_others(mesh, predicted, element_metrics, scheme=scheme)]


def judge_by_others(
    mesh: VolumeMesh,
    predicted: BettiNumbers,
    element_metrics: pd.DataFrame | None,
    *,
    scheme: Scheme = PINCH_TEMPLATES,
) -> list[Check]:
    """Return the checks of a mesh by VTK, MFEM and pymeshlab.

    Parameters
    ----------
    mesh, predicted, element_metrics, scheme
        See `judge_mesh`; our own checks of the mesh hold.
    """
    return [
        _vtk_jacobian(element_metrics, scheme, mesh),
        _matrix_components(mesh, predicted),
        *judge_surface(mesh, predicted),
    ]


def judge_alone(
    mesh: VolumeMesh,
    predicted: BettiNumbers,
    skipped: str = "",
    *,
    scheme: Scheme = PINCH_TEMPLATES,
) -> list[Check]:
    """Return the checks that need no other program.

    Parameters
    ----------
    mesh, predicted
        See `judge_mesh`.
    skipped
        Why the checks by other programs are not run; empty: they have no rows.
    scheme
        See `judge_mesh`.
    """
    measured = mesh.measurement
    if not measured.is_sound:
        return list(measured.checks)
    return [
        *measured.checks,
        _equal(
            "betti_by_euler", "Betti numbers by Euler characteristic", measured.by_euler, predicted
        ),
        _equal("betti_by_boundary", "Betti numbers by boundary", measured.by_boundary, predicted),
        _within(
            "scaled_jacobian",
            "smallest scaled Jacobian",
            measured.smallest_scaled_jacobian,
            scheme,
            mesh=mesh,
        ),
        check_overlap(mesh),
        *(skip_others(skipped) if skipped else ()),
    ]


def skip_others(reason: str) -> list[Check]:
    """Return a row for each other program that says why it did not check a mesh.

    Parameters
    ----------
    reason
        Why it did not.
    """
    return [_not_run(program, reason) for program in _OTHERS]


def _not_run(program: str, reason: str) -> Check:
    """Return a row that says why a program did not check a mesh."""
    return Check(
        id=f"checks_by_{program.lower()}",
        name=f"checks by {program}",
        found=f"not run: {reason}",
        required="the same result",
        holds=None,
    )


def to_table(checks: Sequence[Check]) -> pd.DataFrame:
    """Return checks as a table: id, material, name, found, required, holds, remedy.

    `holds` is "yes", "no", "not run", or "warning" for a warning that does not hold.

    Parameters
    ----------
    checks
        The checks, in the order of the rows.
    """
    return pd.DataFrame(
        [
            (c.id, c.material, c.name, str(c.found), c.required, _in_words(c), c.remedy)
            for c in checks
        ],
        columns=["id", "material", "name", "found", "required", "holds", "remedy"],
    )


def _in_words(check: Check) -> str:
    if check.holds is False and check.is_warning:
        return "warning"
    return {True: "yes", False: "no", None: "not run"}[check.holds]


def overall(checks: pd.DataFrame) -> str:
    """Return the overall verdict of a table of checks.

    It is "suitable", "suitable with warnings" followed by their names, or "not suitable".

    Parameters
    ----------
    checks
        See `to_table`.

    Examples
    --------
    >>> passed = Check(id="a", name="first", found=0, required="0", holds=True)
    >>> failed = Check(id="b", name="second", found=1, required="0", holds=False)
    >>> overall(to_table([passed, failed]))
    'not suitable: 1 check fails'
    """
    n_failed = int((checks["holds"] == "no").sum())
    n_missing = int((checks["holds"] == "not run").sum())
    if n_failed:
        return f"not suitable: {n_failed} check{'s' if n_failed > 1 else ''} " + (
            "fail" if n_failed > 1 else "fails"
        )
    not_run = f" ({n_missing} not run)" if n_missing else ""
    warned = checks.loc[checks["holds"] == "warning", "name"]
    if len(warned):
        return f"suitable with warnings: {'; '.join(map(str, warned))}{not_run}"
    return f"suitable{not_run}"


def compare_volumes(facts: Mapping[str, Any]) -> str:
    """Return the volume of a mesh in words, relative to that of the geometry if it is known.

    Parameters
    ----------
    facts
        See `tusqh.pipeline.build.Built.facts`.

    Examples
    --------
    >>> compare_volumes({"volume": 3.0, "reference_volume": 4.0, "reference_source": "the volume"})
    '0.7500 of the volume'
    >>> compare_volumes({"volume": 3.0, "reference_volume": 0.0})
    '3'
    """
    if not facts.get("reference_volume"):
        return f"{facts['volume']:.6g}"
    return f"{facts['volume'] / facts['reference_volume']:.4f} of {facts['reference_source']}"


def describe_contacts(facts: Mapping[str, Any]) -> str:
    """Return the numbers of contacts and of overruled votes in words.

    Parameters
    ----------
    facts
        See `tusqh.pipeline.build.Built.facts`.

    Examples
    --------
    >>> describe_contacts({"contacts": 1, "overruled": 0})
    '1 contact decided by its vote'
    >>> describe_contacts({"contacts": 1500, "overruled": 2})
    '1,500 contacts decided by their votes, 2 of them overruled'
    """
    n = facts["contacts"]
    count = "1 contact decided by its vote" if n == 1 else f"{n:,} contacts decided by their votes"
    return count + (f", {facts['overruled']:,} of them overruled" if facts["overruled"] else "")


def describe_changes(facts: Mapping[str, Any]) -> dict[str, str]:
    """Return a line on the cells that the topology costs; none with one threshold.

    Parameters
    ----------
    facts
        See `tusqh.pipeline.build.Built.facts`.

    Examples
    --------
    >>> describe_changes({"base": 0.5, "changed_cells": 8, "changed_groups": 1})
    {'changes': '8 cells in 1 group differ from those of the threshold 0.5'}
    """
    if "base" not in facts:
        return {}
    n_cells, n_groups = facts["changed_cells"], facts["changed_groups"]
    base = f"those of the threshold {facts['base']:.6g}"
    if n_cells == 0:
        return {"changes": f"none: the cells are {base}"}
    cells = "1 cell differs" if n_cells == 1 else f"{n_cells:,} cells"
    if n_cells > 1:
        cells += f" in {n_groups:,} group{'s' if n_groups > 1 else ''} differ"
    return {"changes": f"{cells} from {base}"}


def _vtk_jacobian(metrics: pd.DataFrame | None, scheme: Scheme, mesh: VolumeMesh) -> Check:
    identifier, name = "scaled_jacobian_vtk", "smallest scaled Jacobian by VTK"
    if metrics is None:
        return Check(
            id=identifier,
            name=name,
            found="not run: VTK is not installed",
            required=f">= {scheme.bound_of(mesh):.6f}",
            holds=None,
        )
    smallest = float(metrics["scaled_jacobian"].min(skipna=False))
    return _within(identifier, name, smallest, scheme, mesh=mesh)


def _matrix_components(mesh: VolumeMesh, predicted: BettiNumbers) -> Check:
    identifier, name = "matrix_components", "components of MFEM's matrix"
    try:
        found: object = count_matrix_components(mesh)
    except MissingExtraError as reason:
        return Check(
            id=identifier,
            name=name,
            found=f"not run: {reason.where} is not installed",
            required=str(predicted.betti_0),
            holds=None,
        )
    except TusqhError as reason:
        found = f"rejected: {reason.found}"
    return _equal(identifier, name, found, predicted.betti_0)


def check_overlap(mesh: VolumeMesh) -> Check:
    """Return the check that elements do not overlap; in 3D it compares two volumes.

    Parameters
    ----------
    mesh
        The mesh; in 3D, the volume of its elements must be that within its boundary.
    """
    if mesh.dim == 2:
        name, share = "share of the area covered twice", measure_overlap(mesh)
    else:
        name = "enclosed and filled volume, relative difference"
        share = abs(mesh.measurement.enclosed / mesh.measurement.volume - 1)
    return Check(
        id="overlap",
        name=name,
        found=f"{share:.1e}",
        required=f"<= {_OVERLAP:g}",
        holds=share <= _OVERLAP,
    )


def _equal(identifier: str, name: str, found: object, required: object) -> Check:
    return Check(
        id=identifier, name=name, found=found, required=str(required), holds=found == required
    )


def _within(identifier: str, name: str, found: float, scheme: Scheme, *, mesh: VolumeMesh) -> Check:
    return Check(
        id=identifier,
        name=name,
        found=f"{found:.6f}",
        required=f">= {scheme.bound_of(mesh):.6f}",
        holds=scheme.allows(found, mesh),
    )
