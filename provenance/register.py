"""Read the register of data, which holds the origin, licence and digest of each source."""

from __future__ import annotations

import csv
from pathlib import Path

from tusqh.errors import ProvenanceError

#: The register, relative to a checkout or to a folder with its own register.
REGISTER = Path("data_sources/register.csv")

_REQUIRED = {"file", "origin", "url", "licence", "sha256"}


def read_register(*folders: Path) -> dict[str, dict[str, str]]:
    """Return the rows of the first register that exists in some folders, by file.

    If several models use the same file, the row of the first model is returned.

    Parameters
    ----------
    *folders
        Folders to search for `REGISTER`.

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
            missing = sorted(_REQUIRED - set(reader.fieldnames or []))
            rows = [row for row in reader if row.get("file")]
    except (OSError, UnicodeDecodeError, csv.Error) as reason:
        raise _broken(path, str(reason)) from reason
    if missing:
        raise _broken(path, f"the column {', '.join(missing)} is missing")
    return {row["file"]: row for row in reversed(rows)}


def _broken(path: Path, found: str) -> ProvenanceError:
    return ProvenanceError(
        found,
        where=str(path),
        expected=f"a CSV file with the columns {', '.join(sorted(_REQUIRED))}",
        remedy=f"git checkout {path}",
    )
