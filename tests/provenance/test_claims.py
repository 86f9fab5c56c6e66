"""Claims are decided by tables; refuted and broken claims are reported."""

import itertools

import numpy as np
import pandas as pd
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from provenance.claims import CLAIM_COLUMNS, changed_claims, evaluate_claims, load_claims
from tusqh.errors import ConfigError

TABLE = pd.DataFrame(
    {"scheme": ["a", "a", "b"], "value": [1.0, 3.0, 9.0], "holds": [True, True, False]}
)
CLAIM = {
    "id": "largest",
    "statement": "The values of a are at most 3.",
    "section": "ours",
    "table": "results/t.csv",
    "rows": "scheme == 'a'",
    "column": "value",
    "statistic": "max",
    "relation": "<=",
    "expected": 3,
    "accepted": "holds",
}


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "results").mkdir()
    TABLE.to_csv(tmp_path / "results/t.csv", index=False)
    return tmp_path


def evaluate(folder, **changes):
    claim = {key: value for key, value in (CLAIM | changes).items() if value is not None}
    return evaluate_claims([claim], folder, tables=[CLAIM["table"]]).iloc[0]


@pytest.mark.parametrize(
    ("changes", "found", "margin", "status"),
    [
        ({}, "3.0", 0, "holds"),
        ({"relation": "<"}, "3.0", 0, "refuted"),
        ({"expected": 2.5}, "3.0", -0.5, "refuted"),
        ({"expected": 2.5, "tolerance": 0.75}, "3.0", 0.25, "holds"),
        ({"statistic": "min", "relation": ">=", "expected": 2}, "1.0", -1, "refuted"),
        ({"statistic": "mean", "relation": "==", "expected": 2}, "2.0", 0, "holds"),
        ({"statistic": "sum", "relation": "between", "expected": [3, 9]}, "4.0", 1, "holds"),
        ({"statistic": "sum", "relation": "between", "expected": [5, 9]}, "4.0", -1, "refuted"),
        ({"statistic": "count", "relation": ">", "expected": 1}, "2", 1, "holds"),
        ({"rows": "scheme == 'c'", "statistic": "count", "expected": 0}, "0", 0, "holds"),
        (
            {"column": "holds", "statistic": "all", "relation": "==", "expected": True},
            "true",
            0,
            "holds",
        ),
        (
            {"column": "holds", "rows": None, "statistic": "all", "relation": "=="}
            | {"expected": True},
            "false",
            -1,
            "refuted",
        ),
        (
            {"column": "holds", "rows": None, "statistic": "any", "relation": "=="}
            | {"expected": True},
            "true",
            0,
            "holds",
        ),
    ],
)
def test_every_statistic_and_relation(folder, changes, found, margin, status):
    row = evaluate(folder, **changes)
    assert (row["found"], row["margin"], row["status"]) == (found, margin, status)


def test_texts_are_compared_without_a_margin(folder):
    text = {"column": "scheme", "rows": None, "statistic": "first", "relation": "=="}
    assert evaluate(folder, **text, expected="a")["status"] == "holds"
    row = evaluate(folder, **text, expected="b")
    assert row["status"] == "refuted"
    assert np.isnan(row["margin"])


def test_a_claim_that_cannot_be_tested_is_a_row(folder):
    no_rows = evaluate(folder, rows="scheme == 'c'")
    no_table = evaluate(folder, table="results/other.csv")
    never = {"id": "x", "statement": "s", "section": "1", "cannot_be_tested": "No scan."}
    never["accepted"] = "cannot be tested"
    row = evaluate_claims([never], folder, tables=[]).iloc[0]
    assert list(row.index) == CLAIM_COLUMNS
    assert row["explanation"] == "No scan."
    assert {no_rows["status"], no_table["status"], row["status"]} == {"cannot be tested"}


def test_a_missing_value_refutes_a_claim(folder):
    TABLE.assign(value=[1.0, np.nan, 2.0]).to_csv(folder / "results/t.csv", index=False)
    assert evaluate(folder)["status"] == "refuted"


def test_a_claim_is_changed_when_its_status_is_not_the_accepted_one(folder):
    claims = [
        CLAIM | {"id": "as-accepted", "expected": 2, "accepted": "refuted"},
        CLAIM | {"id": "no-longer-refuted", "accepted": "refuted"},
        CLAIM | {"id": "no-longer-holds", "expected": 2},
        CLAIM | {"id": "no-row", "rows": "scheme == 'c'"},
    ]
    tables = [CLAIM["table"]]
    evaluated = evaluate_claims(claims, folder, tables=tables)
    changed = changed_claims(evaluated, tables=tables)["id"].tolist()
    assert changed == ["no-longer-refuted", "no-longer-holds", "no-row"]


def test_a_configuration_without_a_table_changes_no_claim(folder):
    tables = [CLAIM["table"]]
    claims = [
        CLAIM | {"id": "no-table", "table": "results/other.csv"},
        CLAIM | {"id": "no-row", "rows": "scheme == 'c'"},
        CLAIM | {"id": "no-longer-holds", "expected": 2},
    ]
    evaluated = evaluate_claims(claims, folder, tables=tables)
    assert changed_claims(evaluated, tables=tables)["id"].tolist() == ["no-longer-holds"]


@given(
    found=st.floats(-10, 10),
    expected=st.floats(-10, 10),
    tolerance=st.floats(0, 5),
    relation=st.sampled_from(["<=", ">=", "=="]),
)
def test_the_margin_is_the_distance_to_the_change_of_status(
    tmp_path_factory, found, expected, tolerance, relation
):
    folder = tmp_path_factory.mktemp("claims")
    (folder / "results").mkdir()
    pd.DataFrame({"value": [found]}).to_csv(folder / "results/t.csv", index=False)
    changes = {"rows": None, "relation": relation, "expected": expected, "tolerance": tolerance}
    row = evaluate(folder, **changes)
    assert (row["status"] == "holds") == (row["margin"] >= 0)
    # With just enough more tolerance a refuted claim holds.
    more = max(-row["margin"], 0) + 1e-9
    assert evaluate(folder, **changes | {"tolerance": tolerance + more})["status"] == "holds"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"column": "valeu"}, "claim largest"),
        ({"rows": "schema == 'a'"}, "schema"),
        ({"rows": "scheme =="}, "claim largest"),
        ({"column": "scheme"}, "claim largest"),
    ],
)
def test_a_claim_that_does_not_fit_its_table_is_an_error(folder, changes, message):
    with pytest.raises(ConfigError, match=message):
        evaluate(folder, **changes)


@pytest.mark.parametrize(
    "change",
    [
        *({key: None} for key in ("id", "statement", "column", "relation", "expected", "accepted")),
        {"statistic": "median"},
        {"relation": "between"},
        {"expected": [1, 2]},
        {"cannot_be_tested": "both"},
        {"tolerance": -1},
        {"id": "Not Kebab"},
        {"accepted": "fails"},
        {"extra": 1},
    ],
    ids=str,
)
def test_the_schema_refuses(repository, tmp_path, change):
    claim = {key: value for key, value in (CLAIM | change).items() if value is not None}
    path = tmp_path / "claims.yaml"
    path.write_text(yaml.safe_dump([claim]))
    with pytest.raises(ConfigError, match=r"claims\.yaml"):
        load_claims(path, repository / "workflow/schemas/claims.schema.yaml")


def test_ids_are_unique(repository, tmp_path):
    path = tmp_path / "claims.yaml"
    path.write_text(yaml.safe_dump([CLAIM, CLAIM]))
    with pytest.raises(ConfigError, match="duplicate id"):
        load_claims(path, repository / "workflow/schemas/claims.schema.yaml")


def test_the_projects_claims_follow_the_schema_and_name_models_that_exist(repository):
    schema = repository / "workflow/schemas/claims.schema.yaml"
    claims = load_claims(repository / "workflow/claims.yaml", schema)
    models = yaml.safe_load((repository / "config/config.yaml").read_text())["models"]
    tables = {claim["table"].split("/")[1] for claim in claims if "table" in claim}
    assert tables <= {"tables", *models}
    sections = itertools.groupby(sorted(claim["section"] for claim in claims))
    assert len(list(sections)) > 1
