"""Trace the origin of a file to the steps and sources behind it and to the register of data."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from provenance.digests import Digests
from provenance.stamp import read_mark, source_mark
from provenance.stored import RECORDS, Record
from tusqh.errors import ProvenanceError
from tusqh.hashing import hash_file


@dataclass(frozen=True)
class Origin:
    """A file and its origin.

    Parameters
    ----------
    path, sha256
        The file, and its digest when it was written or read.
    is_same
        Whether the file still has that digest.
    step
        The step that made the file; empty for a source.
    parameters, code
        The parameters and the script of the step.
    source
        Row of the file in the register of data; empty if it has none.
    inputs
        The inputs of the step.
    """

    path: str
    sha256: str
    is_same: bool
    step: str = ""
    parameters: dict[str, Any] = field(default_factory=dict)
    code: dict[str, str] = field(default_factory=dict)
    source: dict[str, str] = field(default_factory=dict)
    inputs: tuple[Origin, ...] = ()


@dataclass(frozen=True)
class Match:
    """The recorded file as which a file was identified.

    Parameters
    ----------
    path
        The recorded output or source.
    how
        How the file was identified: by its bytes, its mark or its name.
    is_same
        Whether the file has the recorded bytes, or the mark of the recorded figure.
    """

    path: str
    how: str
    is_same: bool = True


def find_output(path: Path, records: dict[str, Record], digests: Digests) -> Match:
    """Identify a file, in any location, as a recorded output or source.

    It is identified by its bytes, otherwise by the mark in a figure, otherwise by its name.

    Parameters
    ----------
    path
        The file.
    records
        All records by the key of their step.
    digests
        Digests of the files in the current folder.

    Returns
    -------
    Match
        The recorded file, and how it was identified.

    Raises
    ------
    ProvenanceError
        No record contains it.
    """
    name = path.as_posix()
    known = {p: digest for r in records.values() for p, digest in (r.outputs | r.inputs).items()}
    mark = None
    if name in known and digests.of(name) == known[name]:
        return Match(name, "as recorded")
    if path.is_file():
        digest = hash_file(path)
        for other, recorded in known.items():
            if recorded == digest:
                return Match(other, "the same bytes")
        mark = read_mark(path)
        for record in records.values():
            figure = str(mark and mark.get("file"))
            is_known = figure in record.outputs and not record.problem
            if is_known and mark == source_mark(record.what, figure):
                return Match(figure, "other bytes, but the mark of that figure")
    if name in known:
        return Match(name, "the same name, but other bytes", is_same=False)
    if mark:
        raise ProvenanceError(
            f"drawn by {mark.get('step')} of {mark.get('model')} from other sources",
            where=name,
            expected="a figure drawn from sources with SHA-256 " + str(mark.get("sha256")),
            remedy="search the results of other versions; git log results/lock.json lists them",
        )
    raise ProvenanceError(
        "no record contains this file"
        if path.is_file()
        else "neither a file nor a record has this name",
        where=name,
        expected="an output or source of the workflow, a copy of one, or a figure with a mark",
        remedy="run the command in the folder that contains results/provenance",
    )


def lacks_record(path: str) -> bool:
    """Return whether a file without a record should have one.

    Parameters
    ----------
    path
        The file, relative to the current folder.

    Examples
    --------
    >>> lacks_record("results/cow/mesh.vtu"), lacks_record("data_sources/cow.stl")
    (True, False)
    """
    return Path(path).is_relative_to("results") and not Path(path).is_relative_to(RECORDS)


def trace(
    path: str,
    records: dict[str, Record],
    register: dict[str, dict[str, str]],
    digests: Digests,
) -> Origin:
    """Return the origin of a recorded output or source.

    Parameters
    ----------
    path
        The output or source, as records name it.
    records
        All records by the key of their step.
    register
        The register of data by file.
    digests
        Digests of the files in the current folder.
    """
    makers = {p: key for key, r in records.items() if not r.problem for p in r.outputs}
    read = {p: digest for r in records.values() for p, digest in r.inputs.items()}
    known: dict[str, Origin] = {}

    def origin(name: str) -> Origin:
        if name not in known:
            known[name] = make(name)
        return known[name]

    def make(name: str) -> Origin:
        if name not in makers:
            digest = read[name]
            # A result without a record cannot be traced to a step, so it counts as changed.
            same = digests.of(name) == digest and not lacks_record(name)
            return Origin(name, digest, same, source=register.get(name, {}))
        record = records[makers[name]]
        digest = record.outputs[name]
        return Origin(
            name,
            digest,
            digests.of(name) == digest,
            step=makers[name],
            parameters=record.what["parameters"],
            code=record.what["code"],
            inputs=tuple(as_read(origin(p), digest) for p, digest in sorted(record.inputs.items())),
        )

    def as_read(source: Origin, digest: str) -> Origin:
        """Return an input; it is marked as changed if the step read another version of it."""
        return source if source.sha256 == digest else replace(source, is_same=False)

    return origin(path)
