"""Claims of the paper and of this project, each decided by one statistic of one table.

A claim that fails is a row, not an error; so is one that cannot be tested.
"""

from __future__ import annotations

import json
import math
from collections.abc import Collection
from pathlib import Path
from typing import Any

import jsonschema
import pandas as pd
import yaml

from tusqh.errors import ConfigError

Claim = dict[str, Any]

COLUMNS = [
    *("id", "statement", "section", "table", "found", "relation", "expected", "tolerance"),
    *("margin", "status", "explanation"),
]
HOLDS, FAILS, CANNOT_BE_TESTED = "holds", "fails", "cannot be tested"


def load_claims(path: Path, schema_path: Path) -> list[Claim]:
    """Return the claims in a YAML file.

    Raises
    ------
    ConfigError
        The file cannot be read, breaks the schema, or has an id twice.
    """
    try:
        claims = yaml.safe_load(path.read_text("utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as reason:
        raise ConfigError(
            f"cannot be read: {reason}",
            where=str(path),
            expected="a YAML list of claims",
            remedy="correct the place named above",
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
            expected=f"what {schema_path.name} allows",
            remedy="correct the claim; the schema describes every key",
        )
    names = [claim["id"] for claim in claims]
    for name in sorted({name for name in names if names.count(name) > 1}):
        raise ConfigError(
            f"the id {name!r} stands twice",
            where=str(path),
            expected="every id once",
            remedy="rename one of the two",
        )
    return list(claims)


def evaluate_claims(claims: list[Claim], folder: Path, *, tables: Collection[str]) -> pd.DataFrame:
    """Return one row per claim, with what its table says today.

    Parameters
    ----------
    claims
        As `load_claims` returns them.
    folder
        The folder that the names of tables are relative to.
    tables
        The tables that there are; claims about others cannot be tested.

    Returns
    -------
    pandas.DataFrame
        With `COLUMNS`.  ``found`` and ``expected`` are JSON.  ``margin`` is the distance to
        failing in units of the column, negative when the claim fails, empty for texts.

    Raises
    ------
    ConfigError
        A table has no such column, or a query makes no sense for it.
    """
    return pd.DataFrame([_evaluate(claim, folder, tables) for claim in claims], columns=COLUMNS)


def _evaluate(claim: Claim, folder: Path, tables: Collection[str]) -> dict[str, Any]:
    row = {key: claim.get(key, "") for key in COLUMNS} | {"margin": math.nan}
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
            "explanation": "no row of the table is what the claim is about",
        }
    holds, margin = _compare(found, claim["relation"], claim["expected"], tolerance)
    return row | {
        "found": json.dumps(found),
        "margin": margin,
        "status": HOLDS if holds else FAILS,
    }


def _statistic(claim: Claim, table: pd.DataFrame) -> float | bool | str | None:
    """Return the statistic of a claim, None when it is about no row."""
    try:
        rows = table.query(claim["rows"]) if "rows" in claim else table
        if claim["statistic"] == "count":
            return len(rows)
        column = rows[claim["column"]]
        return None if column.empty else _take(claim["statistic"], column)
    except Exception as reason:  # A query may raise anything that Python can.
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
        # A missing value must not hide: it makes the statistic NaN, and the claim fail.
        value = getattr(column.astype(float), statistic)(skipna=False)
    plain = value.item() if hasattr(value, "item") else value
    return plain if isinstance(plain, bool | str) else float(plain)


def _compare(found: Any, relation: str, expected: Any, tolerance: float) -> tuple[bool, float]:
    """Return whether a relation holds, and the distance to where it begins to fail.

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
