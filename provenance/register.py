"""The register of data: where every source comes from, under which licence, with which digest."""

from __future__ import annotations

import csv
from pathlib import Path

from tusqh.errors import ProvenanceError

#: The register in a checkout, and in any folder that has its own.
REGISTER = Path("data_sources/register.csv")


_COLUMNS = {"file", "origin", "url", "licence", "sha256"}


def read_register(*folders: Path) -> dict[str, dict[str, str]]:
    """Return the rows of the first register that is there, by the name of their file.

    A file with several models has one entry, that of the first.

    Raises
    ------
    ProvenanceError
        The register cannot be read, or lacks a column.
    """
    path = next((folder / REGISTER for folder in folders if (folder / REGISTER).is_file()), None)
    if path is None:
        return {}
    try:
        with path.open(encoding="utf-8", newline="") as stream:
            reader = csv.DictReader(stream)
            missing = sorted(_COLUMNS - set(reader.fieldnames or []))
            rows = [row for row in reader if row.get("file")]
    except (OSError, UnicodeDecodeError, csv.Error) as reason:
        raise _broken(path, str(reason)) from reason
    if missing:
        raise _broken(path, f"there is no column {', '.join(missing)}")
    return {row["file"]: row for row in reversed(rows)}


def _broken(path: Path, found: str) -> ProvenanceError:
    return ProvenanceError(
        found,
        where=str(path),
        expected=f"a CSV file with the columns {', '.join(sorted(_COLUMNS))}",
        remedy=f"git checkout {path}",
    )
