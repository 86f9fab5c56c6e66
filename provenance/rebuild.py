"""Make a model anew in an empty folder, and compare with what is here."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

from provenance.check import DIFFERENT, SAME, short
from provenance.content import read_content
from provenance.equality import Equality, class_of, reached
from provenance.findings import Finding
from provenance.plan import Plan
from provenance.stored import Record
from tusqh.errors import ProvenanceError
from tusqh.hashing import hash_file


def rebuild_model(model: str, plan: Plan, records: dict[str, Record]) -> list[Finding]:
    """Run all steps of a model in a temporary folder, and compare every output.

    The log goes to the terminal while the steps run.

    Raises
    ------
    ProvenanceError
        There is no such model, or a step fails.
    """
    steps = [step for step in plan.steps.values() if step.model == model]
    if not steps:
        models = sorted({step.model for step in plan.steps.values() if step.model})
        raise ProvenanceError(
            f"there is no model {model!r}",
            where="--rebuild",
            expected="one of " + ", ".join(models),
            remedy="name a model of the configuration",
        )
    made = {path for step in steps for path in step.outputs}
    with tempfile.TemporaryDirectory(prefix="tusqh-rebuild-") as name:
        folder = Path(name)
        needed = {path for step in steps for path in step.inputs} - made
        for path in [*map(Path, sorted(needed)), *plan.config_files]:
            if path.is_file() and not path.is_absolute():
                (folder / path).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(path, folder / path)
        _run(plan, folder, sorted(made))
        return _compare(model, folder, plan, records)


def _run(plan: Plan, folder: Path, targets: list[str]) -> None:
    command = [sys.executable, "-m", "snakemake", "--cores", "all", "--directory", str(folder)]
    command += ["--snakefile", str(plan.snakefile.resolve())]
    if plan.given_config_files:
        command += ["--configfile", *(str(p.resolve()) for p in plan.given_config_files)]
    done = subprocess.run([*command, "--", *targets], stdout=sys.stderr)
    if done.returncode:
        raise ProvenanceError(
            f"snakemake ended with exit code {done.returncode}",
            where=f"rebuilding {targets[0].split('/')[1]}",
            expected="all steps to succeed",
            remedy="its messages above say which step failed and why",
        )


def _compare(model: str, folder: Path, plan: Plan, records: dict[str, Record]) -> list[Finding]:
    findings = []
    classes: dict[str, Equality | None] = {}
    for key, step in plan.steps.items():
        record = records.get(key)
        if step.model != model or record is None:
            continue
        for path in step.outputs:
            new, old = hash_file(folder / path), record.outputs.get(path, "")
            kind = Equality.EXACT if new == old else None
            if kind is None and class_of(path) is Equality.MEASURED:
                kind = Equality.MEASURED
            elif kind is None and class_of(path) is Equality.VISUAL:
                same = all(classes.get(source, Equality.EXACT) for source in step.inputs)
                kind = Equality.VISUAL if same else None
            elif kind is None and Path(path).is_file():
                kind = reached(
                    class_of(path), read_content(folder / path), read_content(Path(path))
                )
            classes[path] = kind
            if kind is None:
                expected = f"{short(old)} as recorded, class {class_of(path)}"
                remedy = f"{plan.remake(path)}; tusqh trace {path}"
                found = f"{short(new)} when made anew"
                findings.append(Finding(DIFFERENT, key, path, found, expected, remedy))
    counts = Counter(str(kind or "different") for kind in classes.values())
    text = ", ".join(f"{n} {kind}" for kind, n in counts.items())
    found, expected = f"{len(classes)} outputs made anew: {text}", "each equal in its class"
    return [*findings, Finding(SAME, model, "rebuild", found, expected, "nothing")]
