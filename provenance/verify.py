"""Verify the results: run all checks, and combine them in one report."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import pandas as pd

from provenance.check import check_records
from provenance.claims import Claim, changed_claims, evaluate_claims
from provenance.compare import Comparison
from provenance.digests import Digests
from provenance.equality import Equality
from provenance.findings import Finding, Outcome, merge, verdict
from provenance.lock import LOCK
from provenance.plan import Plan
from provenance.register import read_register
from provenance.stored import Record
from tusqh.errors import ProvenanceError

#: The step whose parameters are the claims, and its table.
_CLAIMS_STEP = "claims"
_CLAIMS_TABLE = "results/tables/claims.csv"
#: The first word of the `file` of findings about claims whose status has changed.
_CLAIM = "claim "


@dataclass(frozen=True)
class Verification:
    """The result of a verification.

    Parameters
    ----------
    findings
        All findings, one by one; `provenance.findings.merge` summarises them.
    outcomes
        The outcome of each step, in the order of the workflow.
    classes
        The class of equality with the lock that each step reached; None for none or unknown.
    recording_share
        The share of the steps' time that records and digests took; None without records.
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
        """The meaning of the verdict, in a sentence."""
        n_steps, gravest = len(self.outcomes), self.verdict
        if gravest is Outcome.SAME:
            return f"all {n_steps} steps match their records, the lock and today's workflow"
        found = [finding for finding in merge(self.findings) if finding.outcome is gravest]
        n = len(found)
        if all(finding.file.startswith(_CLAIM) for finding in found):
            subject = "1 claim has" if n == 1 else f"{n} claims have"
            return f"the results match their records and the lock, but {subject} another status"
        noun = "difference" if gravest is Outcome.DIFFERENT else "missing item"
        return f"{n} {noun}{'' if n == 1 else 's'} in {n_steps} steps"

    def extended(self, findings: list[Finding]) -> Verification:
        """Return the verification with further findings.

        Parameters
        ----------
        findings
            The further findings.
        """
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


def verify(plan: Plan, records: dict[str, Record], lock: dict[str, Any] | None) -> Verification:
    """Check the results in the current folder against records, sources, workflow, lock and claims.

    Parameters
    ----------
    plan
        The steps that the workflow would run today.
    records
        The records of the steps that ran, by the key of the step.
    lock
        The accepted results; None if there is no lock.

    Returns
    -------
    Verification
        The outcome of each step, all findings and the verdict.
    """
    digests = Digests()
    findings = list(check_records(plan, records, read_register(Path(), plan.base), digests))
    classes: dict[str, Equality | None] = {}
    if lock is None:
        findings.append(
            Finding(
                outcome=Outcome.CANNOT_TELL,
                file=str(LOCK),
                found="no lock",
                expected="a lock to compare with",
                remedy="tusqh lock, if the results are right",
            )
        )
    else:
        comparison = Comparison(lock, plan, records, digests)
        findings += comparison.findings()
        classes = {key: comparison.class_of_step(step) for key, step in plan.steps.items()}
    findings += _check_claims(plan, records, digests)
    outcomes = {key: verdict(f for f in findings if f.step == key) for key in plan.steps}
    return Verification(findings, outcomes, classes, recording_share(records))


def require_lockable(plan: Plan, records: dict[str, Record]) -> None:
    """Raise an error unless results, records and workflow agree and claims have accepted statuses.

    Parameters
    ----------
    plan
        The steps that the workflow would run today.
    records
        The records of the steps that ran, by the key of the step.

    Raises
    ------
    ProvenanceError
        There is a finding; the message names the gravest one.
    """
    digests = Digests()
    findings = list(check_records(plan, records, read_register(Path(), plan.base), digests))
    findings += _check_claims(plan, records, digests)
    if verdict(findings) is not Outcome.SAME:
        gravest = merge(findings)[0]
        raise ProvenanceError(
            f"{gravest.file}: {gravest.found}",
            where="results" + (f" of {gravest.step}" if gravest.step else ""),
            expected=gravest.expected,
            remedy=f"{gravest.remedy}; tusqh verify lists all findings",
        )


def recording_share(records: dict[str, Record]) -> float | None:
    """Return the share of the time of all recorded steps that recording took.

    Parameters
    ----------
    records
        The records of the steps that ran, by the key of the step.
    """
    keys = ("seconds", "seconds_of_recording")
    times = [[record.how.get(key) for key in keys] for record in records.values()]
    known = [pair for pair in times if all(isinstance(time, int | float) for time in pair)]
    working, recording = (sum(column) for column in zip(*known, strict=True)) if known else (0, 0)
    total = recording + working
    return recording / total if total else None


def _check_claims(plan: Plan, records: dict[str, Record], digests: Digests) -> Iterator[Finding]:
    """Evaluate the claims again, and compare their status with the accepted one."""
    step = plan.steps.get(_CLAIMS_STEP)
    if step is None:
        return
    recorded = {path: digest for r in records.values() for path, digest in r.outputs.items()}
    # A table that differs from its record is already a finding, and decides no claim.
    damaged = {path for path in step.inputs if digests.of(path) != recorded.get(path, "")}
    claims: list[Claim] = [
        claim for claim in step.parameters["claims"] if claim.get("table") not in damaged
    ]
    today = evaluate_claims(claims, Path(), tables=step.inputs)
    for row in changed_claims(today, tables=step.inputs).to_dict("records"):
        yield _changed_claim(step.key, row)
    if digests.of(_CLAIMS_TABLE) == recorded.get(_CLAIMS_TABLE, ""):
        table = pd.read_csv(_CLAIMS_TABLE)
        status = dict(zip(table["id"], table["status"], strict=True))
        for row in today.to_dict("records"):
            if status.get(row["id"], row["status"]) != row["status"]:
                yield Finding(
                    outcome=Outcome.DIFFERENT,
                    step=step.key,
                    file=f"{_CLAIMS_TABLE}: {row['id']}",
                    found=str(status[row["id"]]),
                    expected=str(row["status"]),
                    remedy=plan.remake(_CLAIMS_TABLE),
                )


def _changed_claim(step: str, row: dict[Any, Any]) -> Finding:
    """Return the finding about a claim whose status differs from the accepted one."""
    found, remedy = f"{row['status']}", "read workflow/claims.yaml"
    if row["found"]:
        found += f": {row['found']} in {row['table']}, a margin of {row['margin']:.3g}"
        remedy = f"tusqh trace {row['table']}"
    else:
        found += f": {row['explanation']}"
    return Finding(
        outcome=Outcome.DIFFERENT,
        step=step,
        file=f"{_CLAIM}{row['id']}",
        found=found,
        expected=f"{row['accepted']}: {row['statement']} ({row['relation']} {row['expected']})",
        remedy=f"{remedy}; if the new status is right, change `accepted` in workflow/claims.yaml",
    )
