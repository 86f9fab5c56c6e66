"""Describe the results as a Workflow Run RO-Crate, for people and programs that do not know tusqh.

https://www.researchobject.org/workflow-run-crate/profiles/provenance_run_crate (0.5).  The crate is
made from the `what` records alone, so that it repeats byte for byte: times and hosts are in the
`how` records.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from provenance import crate_entities as entities
from provenance import crate_ids
from provenance.crate_entities import Entity
from provenance.stored import Record

_CONTEXT = [
    "https://w3id.org/ro/crate/1.1/context",
    {"sha256": "https://w3id.org/ro/terms/workflow-run#sha256"},
]


def select_records(records: dict[str, Record], targets: Iterable[str]) -> dict[str, Record]:
    """Return the records of all steps behind some files, sorted by key.

    Parameters
    ----------
    records
        All records, possibly also of steps that the workflow no longer has.
    targets
        The files that were requested from the workflow.
    """
    makers = {path: key for key, record in records.items() for path in record.outputs}
    needed: set[str] = set()
    queue = list(targets)
    while queue:
        key = makers.get(queue.pop())
        if key is not None and key not in needed:
            needed.add(key)
            queue += records[key].inputs
    return {key: records[key] for key in sorted(needed)}


def make_crate(
    records: dict[str, Record],
    *,
    about: dict[str, Any],
    register: dict[str, dict[str, str]],
    workflow_files: Iterable[str],
    engine_version: str,
) -> dict[str, Any]:
    """Return the JSON-LD of the crate.

    Parameters
    ----------
    records
        The steps to describe, by key.
    about
        The ``title``, ``authors``, ``version``, ``license`` and ``date-released`` of the project.
    register
        The register of data by file.
    workflow_files
        The copies of the workflow's files inside the crate, relative to `crate_ids.ROOT`.
    engine_version
        The version of Snakemake.
    """
    made = {path for record in records.values() for path in record.outputs}
    outputs = [e for record in records.values() for e in record.what["outputs"]]
    inputs = {e["path"]: e for r in records.values() for e in r.what["inputs"]}
    others = [inputs[path] for path in sorted(inputs) if path not in made]
    rules = {r.what["step"]: r.what["code"]["script"] for _, r in sorted(records.items())}
    tools = sorted({crate_ids.tool_id(script) for script in rules.values()})
    files = [entities.output(entry) for entry in outputs]
    files += [entities.source(entry, register.get(entry["path"], {})) for entry in others]
    files += [
        entities.code_file(path, is_tool=path in tools, version=about["version"])
        for path in sorted(workflow_files)
        if path != entities.WORKFLOW
    ]
    steps = [
        entities.step(position, rule, rules[rule])
        for position, rule in enumerate(sorted(rules), start=1)
    ]
    runs = [entities.run(key, record) for key, record in records.items()]
    controls = [entities.control(key, record) for key, record in records.items()]
    # Some steps read the records of others, which are inside the crate and are not sources.
    sources = [entry for entry in others if not crate_ids.is_inside(entry["path"])]
    graph: list[Entity] = [
        entities.descriptor(),
        entities.root(about, files=files, runs=runs),
        entities.workflow(about, tools=tools, steps=steps),
        *files,
        *steps,
        entities.whole_run(sources, outputs),
        entities.orchestration(controls),
        *runs,
    ]
    for key, record in records.items():
        graph += entities.parameters(key, record)
    graph += [*controls, *entities.context(about, engine_version)]
    return {"@context": _CONTEXT, "@graph": graph}
