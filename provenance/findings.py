"""What a verification finds, and the verdict that follows."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import IntEnum


class Outcome(IntEnum):
    """What a finding means, and the exit code when it is the gravest."""

    SAME = 0
    DIFFERENT = 1
    CANNOT_TELL = 2

    @property
    def text(self) -> str:
        """The outcome in words."""
        return self.name.lower().replace("_", " ")


@dataclass(frozen=True)
class Finding:
    """One thing that a reader should know, with what mends it.

    Parameters
    ----------
    outcome
        What it means; `Outcome.SAME` for a remark that changes nothing.
    step
        The step it is about, several after `merge`; empty when it is about no step.
    file
        The file, or the part of a record, that it was found in.
    found, expected
        What is there and what should be.
    remedy
        The command that mends it, or what to do.
    """

    outcome: Outcome
    step: str
    file: str
    found: str
    expected: str
    remedy: str


def verdict(findings: Iterable[Finding]) -> Outcome:
    """Return different when anything is, else cannot tell when anything could not be compared."""
    outcomes = {finding.outcome for finding in findings}
    return next(
        (o for o in (Outcome.DIFFERENT, Outcome.CANNOT_TELL) if o in outcomes), Outcome.SAME
    )


def merge(findings: Iterable[Finding]) -> list[Finding]:
    """Return findings that say the same of several steps as one that names them all."""
    groups: dict[Finding, list[str]] = {}
    for finding in findings:
        groups.setdefault(replace(finding, step=""), []).append(finding.step)
    merged = [replace(finding, step=_name(steps)) for finding, steps in groups.items()]
    gravity = [Outcome.DIFFERENT, Outcome.CANNOT_TELL, Outcome.SAME]
    return sorted(merged, key=lambda finding: gravity.index(finding.outcome))


def _name(steps: list[str], shown: int = 3) -> str:
    names = list(dict.fromkeys(filter(None, steps)))
    more = f" and {len(names) - shown} more steps" if len(names) > shown else ""
    return ", ".join(names[:shown]) + more
