"""`python -m tusqh.settings`: regenerate the files that follow from the settings."""

from __future__ import annotations

from pathlib import Path

from tusqh.settings.tables import write_all

if __name__ == "__main__":
    for path in write_all(Path.cwd()):
        print(f"written: {path}")
