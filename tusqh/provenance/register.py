"""The register of data: where every source comes from, under which licence, with which digest."""

from __future__ import annotations

import csv
from pathlib import Path

#: The register in a checkout, and in any folder that has its own.
REGISTER = Path("data_sources/register.csv")


def read_register(*folders: Path) -> dict[str, dict[str, str]]:
    """Return the rows of the first register that is there, by the name of their file.

    A file with several models has one entry, that of the first.
    """
    path = next((folder / REGISTER for folder in folders if (folder / REGISTER).is_file()), None)
    if path is None:
        return {}
    with path.open(encoding="utf-8", newline="") as stream:
        rows = [row for row in csv.DictReader(stream) if row["file"]]
    return {row["file"]: row for row in reversed(rows)}
