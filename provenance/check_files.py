"""Check the files that steps read and wrote against their records."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from provenance.digests import Digests, shorten
from provenance.findings import Finding, Outcome
from provenance.plan import Plan, Step
from provenance.register import REGISTER
from provenance.stored import Record
from tusqh.geometry.packaged import locate

_MISSING = "the file does not exist"


@dataclass(frozen=True)
class FileCheck:
    """Check files against records.

    Parameters
    ----------
    plan
        The steps that the workflow would run today.
    records
        The records of the steps that ran, by the key of the step.
    register
        The register of data by file.
    digests
        Digests of the files in the current folder.
    """

    plan: Plan
    records: dict[str, Record]
    register: dict[str, dict[str, str]]
    digests: Digests

    def check_outputs(self, step: Step, record: Record) -> Iterator[Finding]:
        """Compare the outputs of a step with its record.

        Parameters
        ----------
        step
            A step that the workflow would run today.
        record
            What the step recorded when it ran.
        """
        for entry in record.what["outputs"]:
            path, found = entry["path"], self.digests.of(entry["path"])
            if found != entry["sha256"]:
                yield Finding(
                    outcome=Outcome.DIFFERENT,
                    step=step.key,
                    file=path,
                    found=shorten(found) if found else _MISSING,
                    expected=f"{shorten(entry['sha256'])}, which the step wrote",
                    remedy=self.plan.remake(path),
                )
            else:
                yield from self._check_size(step, entry)

    def check_inputs(self, step: Step, record: Record) -> Iterator[Finding]:
        """Compare the inputs of a step with the records of the steps that wrote them.

        Parameters
        ----------
        step
            A step that the workflow would run today.
        record
            What the step recorded when it ran.
        """
        for entry in record.what["inputs"]:
            path = entry["path"]
            maker = self.plan.maker.get(path)
            if path in self.plan.recorder:
                now = self.digests.of(path)
                if now != entry["sha256"]:
                    current = f"{shorten(now)}, its current content" if now else _MISSING
                    yield self._stale_input(step, entry, current)
            elif maker is None:
                yield from self._check_source(step, entry)
            else:
                written = self._written(maker, path)
                if written not in (None, entry["sha256"]):
                    yield self._stale_input(
                        step, entry, f"{shorten(str(written))}, which {maker.key} wrote"
                    )
                elif self.digests.of(path) == entry["sha256"]:
                    yield from self._check_size(step, entry)

    def _written(self, maker: Step, path: str) -> str | None:
        """Return the digest of a file according to the step that wrote it, None if unknown."""
        record = self.records.get(maker.key)
        return None if record is None else record.outputs.get(path)

    def _stale_input(self, step: Step, entry: dict[str, Any], expected: str) -> Finding:
        return Finding(
            outcome=Outcome.DIFFERENT,
            step=step.key,
            file=f"{step.record}: {entry['path']}",
            found=f"the step read {shorten(entry['sha256'])}",
            expected=expected,
            remedy=self.plan.remake(step.outputs[0]),
        )

    def _check_source(self, step: Step, entry: dict[str, Any]) -> Iterator[Finding]:
        """Compare a source with the record of a step that read it, and with the register."""
        path, digest = entry["path"], entry["sha256"]
        found = self.digests.of(path)
        registered = self.register.get(path, {}).get("sha256")
        if found != digest:
            yield Finding(
                outcome=Outcome.DIFFERENT,
                step=step.key,
                file=path,
                found=shorten(found) if found else _MISSING,
                expected=f"{shorten(digest)}, which the step read",
                remedy=f"restore the source file, or {self.plan.command}",
            )
        elif registered and registered != digest:
            yield Finding(
                outcome=Outcome.DIFFERENT,
                step=step.key,
                file=path,
                found=shorten(digest),
                expected=f"{shorten(registered)}, according to {REGISTER}",
                remedy=f"restore the source file, or correct {REGISTER}",
            )
        elif not registered and not self._is_of_project(path):
            yield Finding(
                outcome=Outcome.SAME,
                step=step.key,
                file=path,
                found=f"not in {REGISTER}",
                expected="its origin and licence",
                remedy=f"add a row to {REGISTER}",
            )
        if found == digest:
            yield from self._check_size(step, entry)

    def _is_of_project(self, path: str) -> bool:
        """Return whether a source is the register or a template, which the register omits."""
        workflow = self.plan.base / "workflow"
        return path == str(REGISTER) or Path(path).resolve().is_relative_to(workflow)

    def _check_size(self, step: Step, entry: dict[str, Any]) -> Iterator[Finding]:
        """Compare the size of a file that has the right digest with a record."""
        size = locate(entry["path"]).stat().st_size
        if entry["size"] != size:
            yield Finding(
                outcome=Outcome.DIFFERENT,
                step=step.key,
                file=f"{step.record}: {entry['path']}",
                found=f"a size of {entry['size']} bytes",
                expected=f"{size} bytes, the size of the file with the recorded digest",
                remedy=self.plan.remake(step.outputs[0]),
            )
