"""Make the rows of the summary and of the table of verdicts over all models."""

from __future__ import annotations

from typing import Any

import pandas as pd

from tusqh.quality.verdict import overall


def summarise_model(
    facts: dict[str, Any],
    verdict: pd.DataFrame,
    amount: pd.DataFrame | None,
    defects: pd.DataFrame,
) -> dict[str, Any]:
    """Return one row of the summary over all models.

    Parameters
    ----------
    facts
        The facts that the mesh step wrote, see `tusqh.antialias.resolve.describe_mesh`.
    verdict
        The checks of the mesh.
    amount
        The table of the simulation's snapshots; None: the mesh is in slabs and not simulated.
    defects
        The defects of the geometry; if a surface is balanced, its signed volume is exact.
    """
    count = dict(zip(defects["defect"], defects["count"], strict=True))
    winding_over_exact = float("nan")
    if count.get("unbalanced_edges") == 0:
        exact = float(defects.loc[defects["defect"] == "signed_volume", "measure"].iloc[0])
        winding_over_exact = facts["winding_volume"] / abs(exact)
    found = dict(zip(verdict["id"], verdict["found"], strict=True))
    error = float("nan") if amount is None else float(amount["amount_relative_error"].abs().max())
    return {
        "model": facts["model"],
        "material": "all",
        "grid": facts["grid"],
        "cells": facts["cells_kept"],
        "elements": facts["elements"],
        "threshold": facts["threshold"],
        "base": facts.get("base", float("nan")),
        "changed_cells": facts.get("changed_cells", 0),
        "margin": facts["margin"],
        "betti_predicted": str(tuple(facts["betti_predicted"])),
        "betti_measured": str(tuple(facts["betti_measured"])),
        "contacts": facts["contacts"],
        "overruled": facts["overruled"],
        "bridges": facts["bridges"],
        "removed_components": facts["removed_components"],
        "filled_holes": facts["filled_holes"],
        "volume_over_winding": facts["volume"] / facts["winding_volume"],
        "winding_over_exact": winding_over_exact,
        "min_scaled_jacobian": float(found.get("scaled_jacobian", "nan")),
        "mean_distance": facts.get("fit", {}).get("mean_distance", float("nan")),
        "fell_back": facts.get("fit", {}).get("fell_back", float("nan")),
        "amount_relative_error": error,
        "slabs": facts.get("slabs", 1),
        "verdict": overall(verdict),
    }


def summarise_fit(
    facts: dict[str, Any], fit: dict[str, Any], verdict: pd.DataFrame
) -> dict[str, Any]:
    """Return one row of the table of fitted meshes.

    Parameters
    ----------
    facts
        The facts that the mesh step wrote about the staircase.
    fit
        The record of its fit, see `tusqh.pipeline.fit.Fit.record`.
    verdict
        The checks of the fitted mesh.

    Returns
    -------
    row
        Distances in cells; the error of the volume is NaN if the volume of the geometry is unknown,
        and the number of self-intersections if pymeshlab did not run.
    """
    of_fit, measured = fit["facts"], fit["measured"]
    reference = facts.get("reference_volume") or float("nan")
    found = dict(zip(verdict["id"], verdict["found"], strict=True))
    crossing = str(found.get("pymeshlab_self_intersecting_faces", ""))
    return {
        "model": facts["model"],
        "dimension": facts["dimension"],
        "grid": facts["grid"],
        "elements": of_fit["elements"],
        **of_fit["fit"],
        "volume_error": of_fit["volume"] / reference - 1,
        "self_intersections": int(crossing) if crossing.isdecimal() else float("nan"),
        "betti_same": measured["euler"] == measured["boundary"] == facts["betti_measured"],
    }


def summarise_materials(
    materials: pd.DataFrame,
    verification: pd.DataFrame,
    verdict: pd.DataFrame,
    amount: pd.DataFrame | None = None,
) -> list[dict[str, Any]]:
    """Return the rows of the summary for a model of several materials.

    Parameters
    ----------
    materials, verification, verdict
        The tables of the model; the verification has the same rows as the materials.
    amount
        The table of the simulation's snapshots; None: the model is not simulated.

    Returns
    -------
    rows
        One for each material, with the verdict on it alone, and one for all together, with the
        verdict on everything.  The contacts are those of the whole mesh.
    """
    error = float("nan") if amount is None else float(amount["amount_relative_error"].abs().max())
    rows = []
    for (_, row), (_, verified) in zip(materials.iterrows(), verification.iterrows(), strict=True):
        is_whole = row["material"] == "all"
        own = verdict if is_whole else verdict[verdict["material"] == row["material"]]
        betti = {
            how: str(tuple(int(row[f"betti_{k}_{how}"]) for k in range(3)))
            for how in ("predicted", "measured")
        }
        rows.append(
            {
                "model": verified["model"],
                "material": str(row["material"]),
                "grid": verified["grid"],
                "cells": int(verified["cells_kept"]),
                "elements": int(row["elements"]),
                "threshold": row["threshold"],
                "margin": float("nan"),
                "betti_predicted": betti["predicted"],
                "betti_measured": betti["measured"],
                "contacts": int(verified["contacts"]),
                "overruled": int(verified["overruled"]),
                "bridges": 0,
                "removed_components": 0,
                "filled_holes": 0,
                "volume_over_winding": row["volume"] / row["volume_of_geometry"],
                "winding_over_exact": float("nan"),
                "min_scaled_jacobian": float(row["min_scaled_jacobian"]),
                "amount_relative_error": error if is_whole else float("nan"),
                "slabs": 1,
                "verdict": overall(own),
            }
        )
    return rows


def facts_of_materials(name: str, materials: pd.DataFrame) -> dict[str, Any]:
    """Return the facts about all materials of a model together, for `summarise_verdict`.

    Parameters
    ----------
    name
        The model.
    materials
        Its table of materials, which has a row for all of them.
    """
    (whole,) = materials[materials["material"] == "all"].to_dict("records")
    return {
        "model": name,
        "volume": whole["volume"],
        "reference_volume": whole["volume_of_geometry"],
        "reference_source": "the volume fractions of all materials",
    }


def summarise_verdict(facts: dict[str, Any], verdict: pd.DataFrame, *, file: str) -> dict[str, Any]:
    """Return one row of the table of verdicts.

    Parameters
    ----------
    facts
        The facts that the mesh step wrote, see `tusqh.pipeline.build.Built.facts`.
    verdict
        The checks of the mesh.
    file
        The geometry file.

    Returns
    -------
    row
        One value for each column of ``verdicts.csv``; the ratio is NaN if the reference volume is
        unknown.
    """
    reference = facts.get("reference_volume") or float("nan")
    warned = verdict.loc[verdict["holds"] == "warning", "name"]
    return {
        "model": facts["model"],
        "file": file,
        "reference": facts.get("reference_source", ""),
        "reference_volume": reference,
        "volume": facts["volume"],
        "volume_ratio": facts["volume"] / reference,
        "warnings": "; ".join(map(str, warned)),
        "verdict": overall(verdict).partition(":")[0],
    }
