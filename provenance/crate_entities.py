"""Make the entities of the RO-Crate, with one function for each kind that returns its JSON-LD."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from provenance.crate_ids import file_id, tool_id
from provenance.stored import Record

Entity = dict[str, Any]

#: The root of the crate, and the name of its description.
FILE_NAME = "ro-crate-metadata.json"
#: The identifier of the workflow.
WORKFLOW = "workflow/Snakefile"

_RUN = "#run"
_ORCHESTRATION = "#organize"
_ENGINE = "#snakemake"
_LANGUAGE = "#language"
_AUTHORS = "#authors"
_CRATE_PROFILE = "https://w3id.org/workflowhub/workflow-ro-crate/1.0"
_PROFILES = {
    "https://w3id.org/ro/wfrun/process/0.5": "Process Run Crate",
    "https://w3id.org/ro/wfrun/workflow/0.5": "Workflow Run Crate",
    "https://w3id.org/ro/wfrun/provenance/0.5": "Provenance Run Crate",
    _CRATE_PROFILE: "Workflow RO-Crate",
}
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


def descriptor() -> Entity:
    """Return the description of the crate's own metadata file."""
    return {
        "@id": FILE_NAME,
        "@type": "CreativeWork",
        "about": {"@id": "./"},
        "conformsTo": _refer(["https://w3id.org/ro/crate/1.1", _CRATE_PROFILE]),
    }


def root(about: dict[str, Any], *, files: list[Entity], runs: list[Entity]) -> Entity:
    """Return the crate as a data set, with the files and runs that it contains.

    Parameters
    ----------
    about
        What ``CITATION.cff`` says about the project.
    files
        The entities of the files.
    runs
        The entities of the runs of scripts.
    """
    return {
        "@id": "./",
        "@type": "Dataset",
        "name": f"Results of {about['title']}",
        "description": "Meshes, tables and figures with the steps and sources behind each of them.",
        "datePublished": about["date-released"],
        "license": {"@id": _licence_id(about)},
        "author": {"@id": _AUTHORS},
        "publisher": {"@id": _AUTHORS},
        "conformsTo": _refer(_PROFILES),
        "mainEntity": {"@id": WORKFLOW},
        "hasPart": _refer([WORKFLOW, *_ids(files)]),
        "mentions": _refer([_RUN, *_ids(runs), _ORCHESTRATION]),
    }


def workflow(about: dict[str, Any], *, tools: list[str], steps: list[Entity]) -> Entity:
    """Return the workflow, with its scripts (`tools`) and its steps.

    Parameters
    ----------
    about
        What ``CITATION.cff`` says about the project.
    tools
        Identifiers of the scripts.
    steps
        The entities of the rules.
    """
    return {
        "@id": WORKFLOW,
        "@type": ["File", "SoftwareSourceCode", "ComputationalWorkflow", "HowTo"],
        "name": about["title"],
        "version": about["version"],
        "license": {"@id": _licence_id(about)},
        "encodingFormat": "text/plain",
        "programmingLanguage": {"@id": _LANGUAGE},
        "hasPart": _refer(tools),
        "step": _refer(_ids(steps)),
    }


def whole_run(sources: list[dict[str, Any]], outputs: list[dict[str, Any]]) -> Entity:
    """Return the run of the whole workflow, from its sources to its outputs.

    Parameters
    ----------
    sources
        References to the sources.
    outputs
        References to the outputs.
    """
    return {
        "@id": _RUN,
        "@type": "CreateAction",
        "name": "Run of the workflow",
        "instrument": {"@id": WORKFLOW},
        "object": _refer(file_id(entry) for entry in sources),
        "result": _refer(file_id(entry) for entry in outputs),
    }


def orchestration(controls: list[Entity]) -> Entity:
    """Return the action of Snakemake that started the runs of all steps.

    Parameters
    ----------
    controls
        The actions that started the runs.
    """
    return {
        "@id": _ORCHESTRATION,
        "@type": "OrganizeAction",
        "name": "Run of Snakemake",
        "instrument": {"@id": _ENGINE},
        "object": _refer(_ids(controls)),
        "result": {"@id": _RUN},
    }


def context(about: dict[str, Any], engine_version: str) -> list[Entity]:
    """Return the profiles, licence, authors, language and engine that other entities refer to.

    Parameters
    ----------
    about
        What ``CITATION.cff`` says about the project.
    engine_version
        Version of Snakemake.
    """
    profiles = [
        {"@id": url, "@type": "CreativeWork", "name": name, "version": url.rpartition("/")[2]}
        for url, name in _PROFILES.items()
    ]
    return [
        *profiles,
        {"@id": _licence_id(about), "@type": "CreativeWork", "name": about["license"]},
        {"@id": _AUTHORS, "@type": "Organization", "name": about["authors"]},
        {"@id": _LANGUAGE, "@type": "ComputerLanguage", "name": "Snakemake"},
        {
            "@id": _ENGINE,
            "@type": "SoftwareApplication",
            "name": "Snakemake",
            "softwareVersion": engine_version,
        },
    ]


def output(entry: dict[str, Any]) -> Entity:
    """Return a file that a step wrote, from its entry in a record.

    Parameters
    ----------
    entry
        The entry of the file in a record: its path, digest and size.
    """
    media_type = _MEDIA_TYPES.get(Path(entry["path"]).suffix, "application/octet-stream")
    return {
        "@id": file_id(entry),
        "@type": "File",
        "name": entry["path"],
        "encodingFormat": media_type,
        "contentSize": str(entry["size"]),
        "sha256": entry["sha256"],
    }


def source(entry: dict[str, Any], row: dict[str, str]) -> Entity:
    """Return a source with its row of the register.

    A source is not part of the crate, because the licences of some sources forbid redistribution.

    Parameters
    ----------
    entry
        The entry of the file in a record: its path, digest and size.
    row
        Its row of the register, by column.
    """
    known = {"description": row.get("origin"), "license": row.get("licence"), "url": row.get("url")}
    return output(entry) | {key: value for key, value in known.items() if value}


def code_file(path: str, *, is_tool: bool, version: str) -> Entity:
    """Return a file of the workflow; the scripts of rules are the tools that ran.

    Parameters
    ----------
    path
        The file, relative to the root of the repository.
    is_tool
        Whether it is the script of a rule.
    version
        Version of the project.
    """
    kind = ["File", "SoftwareSourceCode"]
    if is_tool:
        kind.append("SoftwareApplication")
    return {
        "@id": path,
        "@type": kind,
        "name": Path(path).name,
        "version": version,
        "encodingFormat": _MEDIA_TYPES.get(Path(path).suffix, "text/plain"),
    }


def step(position: int, rule: str, script: str) -> Entity:
    """Return a rule as a step of the workflow.

    Parameters
    ----------
    position
        Position of the rule in the workflow, from 1.
    rule
        Name of the rule.
    script
        Script of the rule.
    """
    return {
        "@id": f"{WORKFLOW}#{rule}",
        "@type": "HowToStep",
        "name": rule,
        "position": str(position),
        "workExample": {"@id": tool_id(script)},
    }


def run(key: str, record: Record) -> Entity:
    """Return one run of a script, with its inputs, parameters and outputs.

    Parameters
    ----------
    key
        The key of the step, such as ``chesapeake/mesh``.
    record
        What the step recorded when it ran.
    """
    what = record.what
    read = [file_id(entry) for entry in what["inputs"]]
    return {
        "@id": f"#run/{key}",
        "@type": "CreateAction",
        "name": key,
        "description": f"The step {what['step']}; times and host are in its .how.json record",
        "instrument": {"@id": tool_id(what["code"]["script"])},
        "object": _refer([*read, *_ids(parameters(key, record))]),
        "result": _refer(file_id(entry) for entry in what["outputs"]),
    }


def parameters(key: str, record: Record) -> list[Entity]:
    """Return the parameters of one run of a script.

    Parameters
    ----------
    key
        The key of the step, such as ``chesapeake/mesh``.
    record
        What the step recorded when it ran.
    """
    return [
        {
            "@id": f"#parameter/{key}/{name}",
            "@type": "PropertyValue",
            "name": name,
            "value": json.dumps(value, sort_keys=True),
        }
        for name, value in sorted(record.what["parameters"].items())
    ]


def control(key: str, record: Record) -> Entity:
    """Return the action that started one run of a script.

    Parameters
    ----------
    key
        The key of the step, such as ``chesapeake/mesh``.
    record
        What the step recorded when it ran.
    """
    return {
        "@id": f"#control/{key}",
        "@type": "ControlAction",
        "name": f"Orchestration of {key}",
        "instrument": {"@id": f"{WORKFLOW}#{record.what['step']}"},
        "object": {"@id": f"#run/{key}"},
    }


def _licence_id(about: dict[str, Any]) -> str:
    return f"https://spdx.org/licenses/{about['license']}"


def _ids(entities: Iterable[Entity]) -> list[str]:
    return [entity["@id"] for entity in entities]


def _refer(ids: Iterable[str]) -> Entity | list[Entity]:
    """Return references; as RO-Crate recommends, a single reference is not in a list."""
    references = [{"@id": name} for name in ids]
    return references[0] if len(references) == 1 else references
