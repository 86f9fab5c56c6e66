"""Make the rows of the summary and of the table of verdicts, which have one row per model."""

from __future__ import annotations

from typing import Any

import pandas as pd

from tusqh.quality.verdict import overall


def summarise_model(
    facts: dict[str, Any], verdict: pd.DataFrame, amount: pd.DataFrame, defects: pd.DataFrame
) -> dict[str, Any]:
    """Return one row of the summary over all models.

    Parameters
    ----------
    facts
        The facts that the mesh step wrote, see `tusqh.antialias.resolve.describe_mesh`.
    verdict
        The checks of the mesh.
    amount
        The table of the simulation's snapshots.
    defects
        The defects of the geometry; if a surface is balanced, its signed volume is exact.
    """
    count = dict(zip(defects["defect"], defects["count"], strict=True))
    winding_over_exact = float("nan")
    if count.get("unbalanced_edges") == 0:
        exact = float(defects.loc[defects["defect"] == "signed_volume", "measure"].iloc[0])
        winding_over_exact = facts["winding_volume"] / abs(exact)
    found = dict(zip(verdict["id"], verdict["found"], strict=True))
    return {
        "model": facts["model"],
        "grid": facts["grid"],
        "cells": facts["cells_kept"],
        "elements": facts["elements"],
        "threshold": facts["threshold"],
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
        "amount_relative_error": float(amount["amount_relative_error"].abs().max()),
        "verdict": overall(verdict),
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
