"""The results as a Workflow Run RO-Crate, for people and programs that know nothing of tusqh.

https://www.researchobject.org/workflow-run-crate/profiles/provenance_run_crate (0.5).  Written
from the `what` records alone, so that it repeats byte for byte: times and hosts stay in the `how`
records beside them.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Iterable
from pathlib import Path, PurePosixPath
from typing import Any

from provenance.stored import Record

Entity = dict[str, Any]

#: The crate's root, and its description in it.
ROOT = PurePosixPath("results")
FILE_NAME = "ro-crate-metadata.json"

_WORKFLOW = "workflow/Snakefile"
_ENGINE = "#snakemake"
_PROFILES = {
    "https://w3id.org/ro/wfrun/process/0.5": "Process Run Crate",
    "https://w3id.org/ro/wfrun/workflow/0.5": "Workflow Run Crate",
    "https://w3id.org/ro/wfrun/provenance/0.5": "Provenance Run Crate",
    "https://w3id.org/workflowhub/workflow-ro-crate/1.0": "Workflow RO-Crate",
}
_CONTEXT = [
    "https://w3id.org/ro/crate/1.1/context",
    {"sha256": "https://w3id.org/ro/terms/workflow-run#sha256"},
]
_MEDIA_TYPES = {
    ".csv": "text/csv",
    ".json": "application/json",
    ".md": "text/markdown",
    ".png": "image/png",
    ".svg": "image/svg+xml",
    ".pdf": "application/pdf",
    ".html": "text/html",
    ".vtu": "application/xml",
    ".vtp": "application/xml",
    ".pvd": "application/xml",
    ".py": "text/x-python",
}


def select_records(records: dict[str, Record], targets: Iterable[str]) -> dict[str, Record]:
    """Return the records of all steps behind some files, by key and in its order.

    Parameters
    ----------
    records
        All records that are there, possibly of steps that the workflow no longer has.
    targets
        The files that the workflow was asked for.
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
        Of the project: ``title``, ``authors``, ``version``, ``license`` and ``date-released``.
    register
        The register of data by file.
    workflow_files
        The copies of the workflow's files inside the crate, relative to `ROOT`.
    engine_version
        The version of Snakemake.
    """
    made = {path for record in records.values() for path in record.outputs}
    outputs = [e for record in records.values() for e in record.what["outputs"]]
    inputs = {e["path"]: e for r in records.values() for e in r.what["inputs"]}
    others = [inputs[path] for path in sorted(inputs) if path not in made]
    # Steps may read the records of others, which are in the crate.
    sources = [entry for entry in others if not _is_inside(entry["path"])]
    rules = {r.what["step"]: r.what["code"]["script"] for _, r in sorted(records.items())}
    ids = {entry["path"]: _id(entry) for entry in [*outputs, *others]}
    licence = f"https://spdx.org/licenses/{about['license']}"
    files = [_output(entry) for entry in outputs]
    files += [_source(entry, register.get(entry["path"], {})) for entry in others]
    code = [path for path in sorted(workflow_files) if path != _WORKFLOW]
    files += [_code(path, rules, about["version"]) for path in code]
    steps = [_step(k, rule, rules[rule]) for k, rule in enumerate(sorted(rules), start=1)]
    runs = [_run(key, record, ids) for key, record in records.items()]
    controls = [_control(key, record) for key, record in records.items()]
    whole = {
        "@id": "#run",
        "@type": "CreateAction",
        "name": "Run of the workflow",
        "instrument": {"@id": _WORKFLOW},
        "object": _refer(ids[entry["path"]] for entry in sources),
        "result": _refer(_id(entry) for entry in outputs),
    }
    organize = {
        "@id": "#organize",
        "@type": "OrganizeAction",
        "name": "Run of Snakemake",
        "instrument": {"@id": _ENGINE},
        "object": _refer(control["@id"] for control in controls),
        "result": {"@id": "#run"},
    }
    workflow = {
        "@id": _WORKFLOW,
        "@type": ["File", "SoftwareSourceCode", "ComputationalWorkflow", "HowTo"],
        "name": about["title"],
        "version": about["version"],
        "license": {"@id": licence},
        "encodingFormat": "text/plain",
        "programmingLanguage": {"@id": "#language"},
        "hasPart": _refer(sorted({_tool(script) for script in rules.values()})),
        "step": _refer(step["@id"] for step in steps),
    }
    root = {
        "@id": "./",
        "@type": "Dataset",
        "name": f"Results of {about['title']}",
        "description": "Meshes, tables and figures with the steps and sources behind each of them.",
        "datePublished": about["date-released"],
        "license": {"@id": licence},
        "author": {"@id": "#authors"},
        "publisher": {"@id": "#authors"},
        "conformsTo": _refer(_PROFILES),
        "mainEntity": {"@id": _WORKFLOW},
        "hasPart": _refer([_WORKFLOW, *(file["@id"] for file in files)]),
        "mentions": _refer(["#run", *(run["@id"] for run, _ in runs), "#organize"]),
    }
    entities = [_descriptor(), root, workflow, *files, *steps, whole, organize]
    entities += [run for run, _ in runs] + [value for _, values in runs for value in values]
    entities += [*controls, *_context(licence, about, engine_version)]
    return {"@context": _CONTEXT, "@graph": entities}


def _descriptor() -> Entity:
    return {
        "@id": FILE_NAME,
        "@type": "CreativeWork",
        "about": {"@id": "./"},
        "conformsTo": _refer(["https://w3id.org/ro/crate/1.1", list(_PROFILES)[-1]]),
    }


def _context(licence: str, about: dict[str, Any], engine_version: str) -> list[Entity]:
    profiles = [
        {"@id": url, "@type": "CreativeWork", "name": name, "version": url.rpartition("/")[2]}
        for url, name in _PROFILES.items()
    ]
    return [
        *profiles,
        {"@id": licence, "@type": "CreativeWork", "name": about["license"]},
        {"@id": "#authors", "@type": "Organization", "name": about["authors"]},
        {"@id": "#language", "@type": "ComputerLanguage", "name": "Snakemake"},
        {
            "@id": _ENGINE,
            "@type": "SoftwareApplication",
            "name": "Snakemake",
            "softwareVersion": engine_version,
        },
    ]


def _id(entry: dict[str, Any]) -> str:
    """Return what names a file: its path in the crate, outside of it the digest of its bytes."""
    if _is_inside(entry["path"]):
        return PurePosixPath(entry["path"]).relative_to(ROOT).as_posix()
    digest = base64.urlsafe_b64encode(bytes.fromhex(entry["sha256"])).decode().rstrip("=")
    return f"ni:///sha-256;{digest}"  # RFC 6920


def _is_inside(path: str) -> bool:
    return PurePosixPath(path).is_relative_to(ROOT)


def _output(entry: dict[str, Any]) -> Entity:
    media_type = _MEDIA_TYPES.get(Path(entry["path"]).suffix, "application/octet-stream")
    return {
        "@id": _id(entry),
        "@type": "File",
        "name": entry["path"],
        "encodingFormat": media_type,
        "contentSize": str(entry["size"]),
        "sha256": entry["sha256"],
    }


def _source(entry: dict[str, Any], row: dict[str, str]) -> Entity:
    """Return a source, which stays where it is: some may not be passed on."""
    known = {"description": row.get("origin"), "license": row.get("licence"), "url": row.get("url")}
    return _output(entry) | {key: value for key, value in known.items() if value}


def _code(path: str, rules: dict[str, str], version: str) -> Entity:
    """Return a file of the workflow; scripts of rules are the tools that were run."""
    is_tool = path in {_tool(script) for script in rules.values()}
    kind = ["File", "SoftwareSourceCode", *(["SoftwareApplication"] if is_tool else [])]
    entity = {"@id": path, "@type": kind, "name": Path(path).name, "version": version}
    return entity | {"encodingFormat": _MEDIA_TYPES.get(Path(path).suffix, "text/plain")}


def _tool(script: str) -> str:
    return f"workflow/{script}"


def _step(position: int, rule: str, script: str) -> Entity:
    return {
        "@id": f"{_WORKFLOW}#{rule}",
        "@type": "HowToStep",
        "name": rule,
        "position": str(position),
        "workExample": {"@id": _tool(script)},
    }


def _run(key: str, record: Record, ids: dict[str, str]) -> tuple[Entity, list[Entity]]:
    """Return one run of a script, and the parameters that it was given."""
    what = record.what
    values = [
        {
            "@id": f"#parameter/{key}/{name}",
            "@type": "PropertyValue",
            "name": name,
            "value": json.dumps(value, sort_keys=True),
        }
        for name, value in sorted(what["parameters"].items())
    ]
    read = [ids[entry["path"]] for entry in what["inputs"]]
    run = {
        "@id": f"#run/{key}",
        "@type": "CreateAction",
        "name": key,
        "description": f"The step {what['step']}; times and host are in its .how.json record",
        "instrument": {"@id": _tool(what["code"]["script"])},
        "object": _refer([*read, *(value["@id"] for value in values)]),
        "result": _refer(ids[entry["path"]] for entry in what["outputs"]),
    }
    return run, values


def _control(key: str, record: Record) -> Entity:
    return {
        "@id": f"#control/{key}",
        "@type": "ControlAction",
        "name": f"Orchestration of {key}",
        "instrument": {"@id": f"{_WORKFLOW}#{record.what['step']}"},
        "object": {"@id": f"#run/{key}"},
    }


def _refer(ids: Iterable[str]) -> Entity | list[Entity]:
    """Return references; a single one stands alone, as RO-Crate recommends."""
    references = [{"@id": name} for name in ids]
    return references[0] if len(references) == 1 else references
