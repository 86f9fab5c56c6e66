"""Did I get what you got?  All checks together, as one report."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import pandas as pd

from provenance.check import CANNOT_TELL, DIFFERENT, check_records, digest_now
from provenance.claims import FAILS, Claim, evaluate_claims
from provenance.compare import Comparison
from provenance.equality import Equality
from provenance.findings import Finding, Outcome, merge, verdict
from provenance.plan import Plan
from provenance.register import read_register
from provenance.stored import Record
from tusqh.errors import ProvenanceError

#: The step whose parameters are the claims, and its table.
_CLAIMS = "claims"
_CLAIMS_TABLE = "results/tables/claims.csv"
#: How the findings about claims that fail begin.
_CLAIM = "claim "


@dataclass(frozen=True)
class Report:
    """What a verification says.

    Parameters
    ----------
    findings
        All of them, one by one; `provenance.findings.merge` makes them fewer.
    outcomes
        Of every step, in the order of the workflow.
    classes
        The class of equality with the lock that each step reached, None when none or unknown.
    recording_share
        The part of the steps' time that records and digests took, None without records.
    """

    findings: list[Finding]
    outcomes: dict[str, Outcome]
    classes: dict[str, Equality | None]
    recording_share: float | None

    @property
    def verdict(self) -> Outcome:
        """The gravest outcome."""
        return verdict(self.findings)

    @property
    def summary(self) -> str:
        """What the verdict means, in a sentence."""
        n_steps, grave = len(self.outcomes), self.verdict
        if grave is Outcome.SAME:
            return f"all {n_steps} steps are as recorded, as locked, and as they would be today"
        found = [finding for finding in merge(self.findings) if finding.outcome is grave]
        if all(finding.file.startswith(_CLAIM) for finding in found):
            return f"the results are the same, but {len(found)} of their claims fail"
        n = len(found)
        what = "things differ" if grave is DIFFERENT else "things cannot be compared"
        return f"{n} {what.replace('things', 'thing') if n == 1 else what}, of {n_steps} steps"

    def extended(self, findings: list[Finding]) -> Report:
        """Return the report with more findings."""
        return replace(self, findings=[*self.findings, *findings])

    def to_dict(self) -> dict[str, Any]:
        """Return plain values for JSON."""
        return {
            "verdict": self.verdict.text,
            "exit_code": int(self.verdict),
            "steps": [
                {"step": key, "outcome": outcome.text, "equality": self.classes.get(key)}
                for key, outcome in self.outcomes.items()
            ],
            "findings": [asdict(f) | {"outcome": f.outcome.text} for f in merge(self.findings)],
            "recording_share": self.recording_share,
        }


def verify(plan: Plan, records: dict[str, Record], lock: dict[str, Any] | None) -> Report:
    """Check the results in the present folder against records, sources, workflow, lock and claims.

    Parameters
    ----------
    plan
        What the workflow would do today.
    records
        What it did, by the key of the step.
    lock
        What the results should be, None when there is no lock.
    """
    digest_now.cache_clear()
    findings = list(check_records(plan, records, read_register(Path(), plan.base)))
    classes: dict[str, Equality | None] = {}
    if lock is None:
        remedy = "tusqh lock, when the results are right"
        findings.append(
            Finding(CANNOT_TELL, "", "results/lock.json", "no lock", "a lock to compare", remedy)
        )
    else:
        comparison = Comparison(lock, plan, records)
        findings += comparison.findings()
        classes = {key: comparison.class_of_step(step) for key, step in plan.steps.items()}
    if _CLAIMS in plan.steps:
        findings += _check_claims(plan, records)
    outcomes = {key: verdict(f for f in findings if f.step == key) for key in plan.steps}
    return Report(findings, outcomes, classes, recording_share(records))


def require_lockable(plan: Plan, records: dict[str, Record]) -> None:
    """Raise unless the results are complete and what their records and the workflow say.

    Raises
    ------
    ProvenanceError
        Naming the gravest finding.
    """
    digest_now.cache_clear()
    found = merge(check_records(plan, records, read_register(Path(), plan.base)))
    if verdict(found) is not Outcome.SAME:
        raise ProvenanceError(
            f"{found[0].file}: {found[0].found}",
            where="results" + (f" of {found[0].step}" if found[0].step else ""),
            expected=found[0].expected,
            remedy=f"{found[0].remedy}; tusqh verify lists everything",
        )


def recording_share(records: dict[str, Record]) -> float | None:
    """Return which part of the time of all recorded steps their recording took."""
    keys = ("seconds", "seconds_of_recording")
    times = [[record.how.get(key) for key in keys] for record in records.values()]
    known = [pair for pair in times if all(isinstance(time, int | float) for time in pair)]
    working, recording = (sum(column) for column in zip(*known, strict=True)) if known else (0, 0)
    total = recording + working
    return recording / total if total else None


def _check_claims(plan: Plan, records: dict[str, Record]) -> Iterator[Finding]:
    """Evaluate the claims again, those whose tables are what their records say."""
    step = plan.steps[_CLAIMS]
    recorded = {path: digest for r in records.values() for path, digest in r.outputs.items()}
    claims: list[Claim] = [
        claim
        for claim in step.parameters["claims"]
        if (table := claim.get("table")) is None or digest_now(table) == recorded.get(table, "")
    ]
    today = evaluate_claims(claims, Path(), tables=step.inputs)
    for row in today[today["status"] == FAILS].to_dict("records"):
        yield Finding(
            DIFFERENT,
            step.key,
            f"{_CLAIM}{row['id']}",
            f"{row['found']} in {row['table']}, a margin of {row['margin']:.3g}",
            f"{row['relation']} {row['expected']}: {row['statement']}",
            f"tusqh trace {row['table']}, and read workflow/claims.yaml",
        )
    if digest_now(_CLAIMS_TABLE) == recorded.get(_CLAIMS_TABLE, ""):
        table = pd.read_csv(_CLAIMS_TABLE)
        status = dict(zip(table["id"], table["status"], strict=True))
        for row in today.to_dict("records"):
            if status.get(row["id"], row["status"]) != row["status"]:
                yield Finding(
                    DIFFERENT,
                    step.key,
                    f"{_CLAIMS_TABLE}: {row['id']}",
                    str(status[row["id"]]),
                    str(row["status"]),
                    plan.remake(_CLAIMS_TABLE),
                )
