"""Evaluate claims of the paper and of this project; one statistic of one table decides each.

Each claim declares the status that `tusqh lock` accepted.  A refuted claim is a result; a claim
whose status changes is a difference.
"""

from __future__ import annotations

import json
import math
from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING, Any

import jsonschema
import yaml

from tusqh.errors import ConfigError

if TYPE_CHECKING:
    import pandas as pd

Claim = dict[str, Any]

#: Columns of the table of claims.
CLAIM_COLUMNS = [
    "id",
    "statement",
    "section",
    "table",
    "found",
    "relation",
    "expected",
    "tolerance",
    "margin",
    "status",
    "accepted",
    "explanation",
]
HOLDS, REFUTED, CANNOT_BE_TESTED = "holds", "refuted", "cannot be tested"


def load_claims(path: Path, schema_path: Path) -> list[Claim]:
    """Return the claims in a YAML file.

    Parameters
    ----------
    path
        The file.
    schema_path
        The schema that it must follow.

    Raises
    ------
    ConfigError
        The file cannot be read, does not follow the schema, or contains a duplicate id.
    """
    try:
        claims = yaml.safe_load(path.read_text("utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as reason:
        raise ConfigError(
            f"cannot be read: {reason}",
            where=str(path),
            expected="a YAML list of claims",
            remedy="correct the line that the message names",
        ) from reason
    schema = yaml.safe_load(schema_path.read_text("utf-8"))
    problem = jsonschema.exceptions.best_match(
        jsonschema.Draft202012Validator(schema).iter_errors(claims)
    )
    if problem is not None:
        entry, *keys = [*problem.absolute_path, ""][: max(len(problem.absolute_path), 1)]
        name = claims[entry].get("id", entry) if isinstance(entry, int) else "the list"
        raise ConfigError(
            problem.message,
            where=": ".join(map(str, [path, name, *keys])),
            expected=f"a claim that follows {schema_path.name}",
            remedy="correct the claim; the schema describes every key",
        )
    names = [claim["id"] for claim in claims]
    for name in sorted({name for name in names if names.count(name) > 1}):
        raise ConfigError(
            f"duplicate id {name!r}",
            where=str(path),
            expected="unique ids",
            remedy="rename one of the two",
        )
    return list(claims)


def evaluate_claims(claims: list[Claim], folder: Path, *, tables: Collection[str]) -> pd.DataFrame:
    """Return one row per claim with its current status according to its table.

    Parameters
    ----------
    claims
        The claims, see `load_claims`.
    folder
        The folder to which the names of tables are relative.
    tables
        The tables that exist; claims about others cannot be tested.

    Returns
    -------
    pandas.DataFrame
        A table with `CLAIM_COLUMNS`.  ``found`` and ``expected`` are JSON.  ``margin`` is the
        distance to refutation in units of the column; it is negative for a refuted claim and empty
        for texts.

    Raises
    ------
    ConfigError
        A table lacks a column, or a query does not fit it.
    """
    import pandas as pd

    return pd.DataFrame(
        [_evaluate(claim, folder, tables) for claim in claims], columns=CLAIM_COLUMNS
    )


def changed_claims(evaluated: pd.DataFrame, *, tables: Collection[str]) -> pd.DataFrame:
    """Return the rows of claims whose status differs from the accepted one.

    A configuration without the paper's models lacks tables or rows that claims need.  Unless all
    tables exist, a claim that cannot be tested counts as unchanged.

    Parameters
    ----------
    evaluated
        The claims, see `evaluate_claims`.
    tables
        The tables that exist.
    """
    needed = set(evaluated["table"]) - {""}
    is_changed = evaluated["status"] != evaluated["accepted"]
    if not needed <= set(tables):
        is_changed &= evaluated["status"] != CANNOT_BE_TESTED
    return evaluated[is_changed]


def _evaluate(claim: Claim, folder: Path, tables: Collection[str]) -> dict[str, Any]:
    import pandas as pd

    row = {key: claim.get(key, "") for key in CLAIM_COLUMNS} | {"margin": math.nan}
    if "cannot_be_tested" in claim:
        return row | {"status": CANNOT_BE_TESTED, "explanation": claim["cannot_be_tested"]}
    tolerance = float(claim.get("tolerance", 0))
    row |= {"expected": json.dumps(claim["expected"]), "tolerance": tolerance}
    if claim["table"] not in tables:
        return row | {
            "status": CANNOT_BE_TESTED,
            "explanation": "no step of this configuration makes the table",
        }
    found = _statistic(claim, pd.read_csv(folder / claim["table"]))
    if found is None:
        return row | {
            "status": CANNOT_BE_TESTED,
            "explanation": "the table has no row that the claim concerns",
        }
    holds, margin = _compare(found, claim["relation"], claim["expected"], tolerance)
    return row | {
        "found": json.dumps(found),
        "margin": margin,
        "status": HOLDS if holds else REFUTED,
    }


def _statistic(claim: Claim, table: pd.DataFrame) -> float | bool | str | None:
    """Return the statistic of a claim, None if it concerns no row."""
    try:
        rows = table.query(claim["rows"]) if "rows" in claim else table
        if claim["statistic"] == "count":
            return len(rows)
        column = rows[claim["column"]]
        return None if column.empty else _take(claim["statistic"], column)
    except Exception as reason:  # A query can raise any exception.
        raise ConfigError(
            f"cannot be evaluated: {type(reason).__name__}: {reason}",
            where=f"claim {claim['id']}, {claim['table']}",
            expected="a query and a column of a table with " + ", ".join(map(str, table.columns)),
            remedy="correct `rows` and `column` in workflow/claims.yaml",
        ) from reason


def _take(statistic: str, column: Any) -> float | bool | str:
    if statistic == "first":
        value = column.iloc[0]
    elif statistic in ("all", "any"):
        value = getattr(column.astype(bool), statistic)()
    else:
        # A missing value makes the statistic NaN and refutes the claim.
        value = getattr(column.astype(float), statistic)(skipna=False)
    plain = value.item() if hasattr(value, "item") else value
    return plain if isinstance(plain, bool | str) else float(plain)


def _compare(found: Any, relation: str, expected: Any, tolerance: float) -> tuple[bool, float]:
    """Return whether a relation holds, and the distance to the point where it ceases to hold.

    >>> _compare(0.5, "<=", 0.4, 0.2)
    (True, 0.1)
    >>> _compare(3.0, "between", [1, 2], 0.0)
    (False, -1.0)
    """
    if isinstance(found, str) or isinstance(expected, str):
        return relation == "==" and found == expected, math.nan
    if relation == "between":
        margin = min(found - expected[0], expected[1] - found) + tolerance
    elif relation in ("<=", "<"):
        margin = expected + tolerance - found
    elif relation in (">=", ">"):
        margin = found - expected + tolerance
    else:
        margin = tolerance - abs(float(found) - float(expected))
    margin = round(float(margin), 12)
    return (margin > 0 if relation in ("<", ">") else margin >= 0), margin
