"""Results against the lock, each output in its class of equality."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from provenance.check import (
    CANNOT_TELL,
    DIFFERENT,
    SAME,
    changed_versions,
    digest_now,
    short,
)
from provenance.content import Content, read_content
from provenance.environment import describe_platform, installed_versions
from provenance.equality import Equality, reached, weakest
from provenance.findings import Finding
from provenance.lock import LOCK
from provenance.plan import Plan, Step
from provenance.stored import Record, read_code_list

_ACCEPT = "tusqh lock, when the new results are right"


class Comparison:
    """Results beside a lock.

    Outputs that are not what their record says count as unknown here: `check_records` finds them.

    Parameters
    ----------
    lock
        As `provenance.lock.read_lock` returns it.
    plan
        What the workflow would do today, in the present folder.
    records
        What it did.
    """

    def __init__(self, lock: dict[str, Any], plan: Plan, records: dict[str, Record]) -> None:
        self.lock = lock
        self.plan = plan
        self.records = records
        self._known: dict[str, tuple[Equality | None, str]] = {}

    def class_of_step(self, step: Step) -> Equality | None:
        """Return the weakest class among a step's outputs, None when one reaches none."""
        classes = [self.reach(path)[0] for path in step.outputs]
        return None if None in classes else weakest([kind for kind in classes if kind])

    def reach(self, path: str) -> tuple[Equality | None, str]:
        """Return the class that a file reaches, and how it differs when it reaches none."""
        if path not in self._known:
            self._known[path] = self._reach(path)
        return self._known[path]

    def _reach(self, path: str) -> tuple[Equality | None, str]:
        if path in self.plan.recorder:
            kind = self.class_of_step(self.plan.recorder[path])
            return kind, "" if kind else "the record of another result"
        step = self.plan.maker.get(path)
        if step is None:
            same = digest_now(path) == self.lock["sources"].get(path)
            return (Equality.EXACT, "") if same else (None, "another source")
        digest, entry = self._recorded(step, path), self._locked(step, path)
        if digest is None or entry is None or digest_now(path) != digest:
            return None, ""
        if digest == entry["sha256"]:
            return Equality.EXACT, ""
        kind = Equality(entry["class"])
        if kind is Equality.MEASURED:
            return kind, ""
        if kind is Equality.VISUAL:
            others = [source for source in step.inputs if self.reach(source)[0] is None]
            return (None, f"drawn from another {others[0]}") if others else (kind, "")
        then = Content.from_dict(entry["content"]) if "content" in entry else None
        now = read_content(Path(path)) if then else None
        found = reached(kind, now, then)
        if found or now is None or then is None:
            return found, ""
        difference, where = now.difference(then)
        size = f" by {difference:.2g} of its size" if difference < float("inf") else ""
        return None, f"differs in {where}{size}"

    def _recorded(self, step: Step, path: str) -> str | None:
        record = self.records.get(step.key)
        return None if record is None or record.problem else record.outputs.get(path)

    def _locked(self, step: Step, path: str) -> dict[str, Any] | None:
        entry = self.lock["steps"].get(step.key, {}).get("outputs", {}).get(path)
        return dict(entry) if entry else None

    def findings(self) -> Iterator[Finding]:
        """Find outputs that are not the lock's, steps it does not have, and what has changed."""
        yield from self._remarks()
        yield from self._gone()
        for key, step in self.plan.steps.items():
            if key in self.records and key not in self.lock["steps"]:
                yield Finding(
                    *(CANNOT_TELL, key, str(LOCK), "nothing about the step"),
                    *("what its results should be", _ACCEPT),
                )
                continue
            for path in step.outputs:
                digest, entry = self._recorded(step, path), self._locked(step, path)
                if digest and entry is None:
                    yield Finding(
                        *(CANNOT_TELL, key, path, "nothing about the file in the lock"),
                        *("what it should be", _ACCEPT),
                    )
                kind, why = self.reach(path)
                if kind is None and digest and entry and digest_now(path) == digest:
                    yield Finding(
                        DIFFERENT,
                        key,
                        path,
                        f"{short(digest)} {why}".strip(),
                        f"{short(entry['sha256'])} as locked, class {entry['class']}",
                        f"tusqh trace {path}; {_ACCEPT}",
                    )

    def _gone(self) -> Iterator[Finding]:
        """Find what the lock knows and the workflow does not make today."""
        for key, locked in self.lock["steps"].items():
            step = self.plan.steps.get(key)
            if step is None:
                yield Finding(
                    *(CANNOT_TELL, key, str(LOCK), "steps that the workflow does not have today"),
                    *("the workflow that was locked", f"use its configuration; or {_ACCEPT}"),
                )
                continue
            for path in sorted(locked["outputs"].keys() - set(step.outputs)):
                yield Finding(
                    *(CANNOT_TELL, key, path, "the step does not write it today"),
                    *("a result that was locked", _ACCEPT),
                )

    def _remarks(self) -> Iterator[Finding]:
        """Say what has changed since the lock; the results may be equal all the same."""
        was = {**self.lock["environment"]["versions"]}
        now = installed_versions()
        platform = {k: v for k, v in self.lock["environment"].items() if k != "versions"}
        changes = changed_versions(was, now)
        changes += [(platform[k], v) for k, v in describe_platform().items() if platform[k] != v]
        if changes:
            old, new = (", ".join(side) for side in zip(*changes, strict=True))
            yield _remark("", "environment", f"installed now: {new}", f"when locked: {old}")
        for path, digest in self.lock["sources"].items():
            found = digest_now(path)
            if found and found != digest:
                yield _remark("", path, f"a source with {short(found)}", f"{short(digest)} locked")
        code: dict[str, str] = {}
        for key, record in self.records.items():
            locked = self.lock["steps"].get(key)
            if record.problem or locked is None:
                continue
            code |= read_code_list(record.what["code"]["sha256"])
            if record.what["parameters"] != locked["parameters"]:
                yield _remark(key, "parameters", "others", "those of the lock")
        for file, digest in self.lock["code"].items():
            if code.get(file, digest) != digest:
                yield _remark("", file, f"code with {short(code[file])}", f"{short(digest)} locked")


def _remark(step: str, file: str, found: str, expected: str) -> Finding:
    return Finding(SAME, step, file, found, expected, "nothing, when the results are the same")
