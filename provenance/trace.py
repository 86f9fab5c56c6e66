"""Where a file comes from: every step and source behind it, down to the register of data."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from provenance.check import digest_now
from provenance.stamp import read_mark, source_mark
from provenance.stored import RECORDS, Record
from tusqh.errors import ProvenanceError
from tusqh.hashing import hash_file


@dataclass(frozen=True)
class Origin:
    """A file and what it was made of.

    Parameters
    ----------
    path, sha256
        The file, and its digest when it was written or read.
    is_same
        Whether the file is still so.
    step
        What made it, empty for a source.
    parameters, code
        What the step was told, and the script it ran.
    source
        The row of the register of data, empty when it has none.
    inputs
        What the step read.
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
    """Which recorded output a file is.

    Parameters
    ----------
    path
        The output.
    how
        Why: its name, its bytes, or the mark in it.
    """

    path: str
    how: str


def find_output(path: Path, records: dict[str, Record]) -> Match:
    """Return which recorded output or source a file is, wherever it lies.

    By its bytes, else by the mark of its source in a figure, else by its name.

    Raises
    ------
    ProvenanceError
        No record knows it.
    """
    name = path.as_posix()
    known = {p: digest for r in records.values() for p, digest in (r.outputs | r.inputs).items()}
    mark = None
    if name in known and digest_now(name) == known[name]:
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
                return Match(figure, "other bytes, with the mark of that figure")
    if name in known:
        return Match(name, "the name only: its bytes are not those recorded")
    if mark:
        raise ProvenanceError(
            f"was drawn by {mark.get('step')} of {mark.get('model')}, from other sources than here",
            where=name,
            expected="a source with SHA-256 " + str(mark.get("sha256")),
            remedy="look for it in the results of another version, or git log results/lock.json",
        )
    raise ProvenanceError(
        "no record knows this file" if path.is_file() else "there is no such file, nor a record",
        where=name,
        expected="an output or source of the workflow, a copy of one, or a figure with a mark",
        remedy="run the command in the folder that has results/provenance",
    )


def lacks_record(path: str) -> bool:
    """Return whether a file that no step has a record of should have one.

    >>> lacks_record("results/cow/mesh.vtu"), lacks_record("data_sources/cow.stl")
    (True, False)
    """
    return Path(path).is_relative_to("results") and not Path(path).is_relative_to(RECORDS)


def trace(path: str, records: dict[str, Record], register: dict[str, dict[str, str]]) -> Origin:
    """Return where a recorded output or source comes from."""
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
            # A result that no step has a record of is not as any step wrote it.
            same = digest_now(name) == digest and not lacks_record(name)
            return Origin(name, digest, same, source=register.get(name, {}))
        record = records[makers[name]]
        digest = record.outputs[name]
        return Origin(
            name,
            digest,
            digest_now(name) == digest,
            step=makers[name],
            parameters=record.what["parameters"],
            code=record.what["code"],
            inputs=tuple(as_read(origin(p), digest) for p, digest in sorted(record.inputs.items())),
        )

    def as_read(source: Origin, digest: str) -> Origin:
        """Return a source, as changed where a step read something else than is recorded."""
        return source if source.sha256 == digest else replace(source, is_same=False)

    return origin(path)
