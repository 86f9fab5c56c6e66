"""Findings of a verification, and the verdict that follows from them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import IntEnum


class Outcome(IntEnum):
    """The meaning of a finding, and the exit code if it is the gravest one."""

    SAME = 0
    DIFFERENT = 1
    CANNOT_TELL = 2

    @property
    def text(self) -> str:
        """The outcome in words."""
        return self.name.lower().replace("_", " ")


@dataclass(frozen=True, kw_only=True)
class Finding:
    """A fact that a reader should know, and how to fix it.

    Parameters
    ----------
    outcome
        Meaning of the finding; `Outcome.SAME` for a remark that does not affect the verdict.
    step
        The step concerned, several steps after `merge`; empty if no step is concerned.
    file
        The file, or the part of a record, concerned.
    found, expected
        The value found, and the value that should be there.
    remedy
        The command or action that fixes it.
    """

    outcome: Outcome
    step: str = ""
    file: str
    found: str
    expected: str
    remedy: str


def verdict(findings: Iterable[Finding]) -> Outcome:
    """Return the gravest outcome: different, then cannot tell, then same.

    Parameters
    ----------
    findings
        What was found.
    """
    outcomes = {finding.outcome for finding in findings}
    return next(
        (o for o in (Outcome.DIFFERENT, Outcome.CANNOT_TELL) if o in outcomes), Outcome.SAME
    )


def merge(findings: Iterable[Finding]) -> list[Finding]:
    """Merge findings that differ only in the step, and sort them, with the gravest first.

    Parameters
    ----------
    findings
        What was found.

    Returns
    -------
    list of Finding
        Merged findings, each with all its steps.
    """
    groups: dict[Finding, list[str]] = {}
    for finding in findings:
        groups.setdefault(replace(finding, step=""), []).append(finding.step)
    merged = [replace(finding, step=_list_steps(steps)) for finding, steps in groups.items()]
    gravity = [Outcome.DIFFERENT, Outcome.CANNOT_TELL, Outcome.SAME]
    return sorted(merged, key=lambda finding: gravity.index(finding.outcome))


def _list_steps(steps: list[str], shown: int = 3) -> str:
    names = list(dict.fromkeys(filter(None, steps)))
    more = f" and {len(names) - shown} more steps" if len(names) > shown else ""
    return ", ".join(names[:shown]) + more
