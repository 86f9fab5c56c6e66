"""Compare the results with the lock, each output in its class of equality."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from provenance.content import Content
from provenance.digests import Digests, shorten
from provenance.environment import changed_versions, describe_platform, installed_versions
from provenance.equality import Equality, is_numerically_equal, weakest
from provenance.findings import Finding, Outcome
from provenance.lock import LOCK
from provenance.plan import Plan, Step
from provenance.read_content import read_content
from provenance.stored import Record, read_code_list

_ACCEPT = "tusqh lock, if the new results are right"


@dataclass(frozen=True)
class Reached:
    """The class of equality that a file reaches.

    Parameters
    ----------
    equality
        The class, None if the file differs or cannot be compared.
    difference
        How it differs, if that is known.
    """

    equality: Equality | None
    difference: str = ""


class Comparison:
    """Compare results with a lock.

    Outputs that differ from their record count as unknown here: `provenance.check` finds them.

    Parameters
    ----------
    lock
        The lock, see `provenance.lock.read_lock`.
    plan
        The steps that the workflow would run today.
    records
        The records of the steps that ran, by the key of the step.
    digests
        Digests of the files in the current folder.
    """

    def __init__(
        self, lock: dict[str, Any], plan: Plan, records: dict[str, Record], digests: Digests
    ) -> None:
        self.lock = lock
        self.plan = plan
        self.records = records
        self.digests = digests
        self._known: dict[str, Reached] = {}

    def class_of_step(self, step: Step) -> Equality | None:
        """Return the weakest class among the outputs of a step, None if one reaches none.

        Parameters
        ----------
        step
            A step that the workflow would run today.
        """
        classes = [self.reach(path).equality for path in step.outputs]
        return None if None in classes else weakest(kind for kind in classes if kind)

    def reach(self, path: str) -> Reached:
        """Return the class of equality that a file reaches.

        Parameters
        ----------
        path
            The file, relative to the current folder.
        """
        if path not in self._known:
            self._known[path] = self._reach(path)
        return self._known[path]

    def _reach(self, path: str) -> Reached:
        if path in self.plan.recorder:
            kind = self.class_of_step(self.plan.recorder[path])
            return Reached(kind, "" if kind else "is the record of another result")
        step = self.plan.maker.get(path)
        if step is None:
            is_same = self.digests.of(path) == self.lock["sources"].get(path)
            return Reached(Equality.EXACT) if is_same else Reached(None, "is another source")
        digest, entry = self._recorded(step, path), self._locked(step, path)
        if digest is None or entry is None or self.digests.of(path) != digest:
            return Reached(None)
        if digest == entry["sha256"]:
            return Reached(Equality.EXACT)
        match Equality(entry["equality"]):
            case Equality.UNCHECKED:
                changed = (p for p in step.inputs if self.reach(p).equality is None)
                source = next(changed, None)
                if source is None:
                    return Reached(Equality.UNCHECKED)
                return Reached(None, f"was made from a changed {source}")
            case Equality.NUMERIC if "content" in entry:
                return _compare_content(Path(path), entry)
            case _:
                return Reached(None)

    def _recorded(self, step: Step, path: str) -> str | None:
        record = self.records.get(step.key)
        return None if record is None or record.problem else record.outputs.get(path)

    def _locked(self, step: Step, path: str) -> dict[str, Any] | None:
        entry = self.lock["steps"].get(step.key, {}).get("outputs", {}).get(path)
        return dict(entry) if entry else None

    def findings(self) -> Iterator[Finding]:
        """Find outputs that differ from the lock, and steps that only one of the two has."""
        yield from self._notes()
        yield from self._find_missing()
        for key, step in self.plan.steps.items():
            if key in self.records and key not in self.lock["steps"]:
                yield Finding(
                    outcome=Outcome.CANNOT_TELL,
                    step=key,
                    file=str(LOCK),
                    found="the lock does not contain the step",
                    expected="the results of the step",
                    remedy=_ACCEPT,
                )
            else:
                for path in step.outputs:
                    yield from self._check_output(step, path)

    def _check_output(self, step: Step, path: str) -> Iterator[Finding]:
        """Compare one output with the lock."""
        digest, entry = self._recorded(step, path), self._locked(step, path)
        if digest and entry is None:
            yield Finding(
                outcome=Outcome.CANNOT_TELL,
                step=step.key,
                file=path,
                found="the lock does not contain the file",
                expected="its digest",
                remedy=_ACCEPT,
            )
        reached = self.reach(path)
        if reached.equality is None and digest and entry and self.digests.of(path) == digest:
            yield Finding(
                outcome=Outcome.DIFFERENT,
                step=step.key,
                file=path,
                found=f"{shorten(digest)} {reached.difference}".strip(),
                expected=f"{shorten(entry['sha256'])} as locked, equality {entry['equality']}",
                remedy=f"tusqh trace {path}; {_ACCEPT}",
            )

    def _find_missing(self) -> Iterator[Finding]:
        """Find steps and files in the lock that the workflow does not make today."""
        for key, locked in self.lock["steps"].items():
            step = self.plan.steps.get(key)
            if step is None:
                yield Finding(
                    outcome=Outcome.CANNOT_TELL,
                    step=key,
                    file=str(LOCK),
                    found="steps that the workflow does not have today",
                    expected="the steps of the workflow that was locked",
                    remedy=f"use the configuration that was locked; or {_ACCEPT}",
                )
                continue
            for path in sorted(locked["outputs"].keys() - set(step.outputs)):
                yield Finding(
                    outcome=Outcome.CANNOT_TELL,
                    step=key,
                    file=path,
                    found="the step does not write it today",
                    expected="a result that was locked",
                    remedy=_ACCEPT,
                )

    def _notes(self) -> Iterator[Finding]:
        """Note what has changed since the lock; the results may still be equal."""
        was = self.lock["environment"]
        changes = changed_versions(was["versions"], installed_versions())
        changes += [(was[k], now) for k, now in describe_platform().items() if was[k] != now]
        if changes:
            old, new = (", ".join(side) for side in zip(*changes, strict=True))
            yield _note(
                file="environment", found=f"installed now: {new}", expected=f"when locked: {old}"
            )
        for path, digest in self.lock["sources"].items():
            found = self.digests.of(path)
            if found and found != digest:
                yield _note(
                    file=path,
                    found=f"a source with {shorten(found)}",
                    expected=f"{shorten(digest)} as locked",
                )
        code: dict[str, str] = {}
        for key, record in self.records.items():
            locked = self.lock["steps"].get(key)
            if record.problem or locked is None:
                continue
            code |= read_code_list(record.what["code"]["sha256"])
            if record.what["parameters"] != locked["parameters"]:
                yield _note(
                    step=key,
                    file="parameters",
                    found="the step has other parameters",
                    expected="the parameters that were locked",
                )
        for file, digest in self.lock["code"].items():
            if code.get(file, digest) != digest:
                yield _note(
                    file=file,
                    found=f"code with {shorten(code[file])}",
                    expected=f"{shorten(digest)} as locked",
                )


def _compare_content(path: Path, entry: dict[str, Any]) -> Reached:
    """Compare the content of a file with that in the lock."""
    then, now = Content.from_dict(entry["content"]), read_content(path)
    if is_numerically_equal(now, then, entry["tolerance"]):
        return Reached(Equality.NUMERIC)
    if now is None:
        return Reached(None)
    difference, where = now.difference(then)
    size = f" by a relative {difference:.2g}" if difference < float("inf") else ""
    return Reached(None, f"differs in {where}{size}")


def _note(*, step: str = "", file: str, found: str, expected: str) -> Finding:
    return Finding(
        outcome=Outcome.SAME,
        step=step,
        file=file,
        found=found,
        expected=expected,
        remedy="nothing, if the results are the same",
    )
