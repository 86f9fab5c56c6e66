"""Write the table of a model's files into docs/files.md: ``python docs/files.py``.

Names, columns and meaning come from `tusqh.files`; writers and readers from the rules.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from tusqh.files import RESULT_FILES, TABLES_OF_ALL_MODELS

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/files.md"
HEAD = """# Files of a model

Every file in `results/<model>/` that is not a result of the paper's studies, in the order in which
the workflow makes them. The names are given once, in `tusqh/files.py`; the rules,
`Result.save`, the explorer and the overview take them from there.
`python docs/files.py` writes this page again.

| name | file | contents | written by | read by |
|---|---|---|---|---|
"""
COLUMNS = """
## Columns

Tables of outlines do not have the columns that end in `k` or `z`.

| file | columns |
|---|---|
"""
ALL_MODELS = """
## Tables over all models

| file in `results/` | contents | columns |
|---|---|---|
"""


def load_rules() -> list[Any]:
    """Return the rules of the workflow, as Snakemake reads them."""
    from snakemake.api import SnakemakeApi
    from snakemake.settings.types import OutputSettings, Quietness, ResourceSettings

    with SnakemakeApi(OutputSettings(quiet={Quietness.ALL})) as api:
        workflow = api.workflow(
            resource_settings=ResourceSettings(cores=1),
            snakefile=ROOT / "Snakefile",
            workdir=ROOT,
        )._workflow
        return list(workflow.rules)


def render_page(rules: list[Any]) -> str:
    """Return the page for the rules of the workflow."""
    text = HEAD
    for file in RESULT_FILES.values():
        path = re.compile(rf"results/(?!tables/)[^/]+/{re.escape(file.path)}")
        writers = [r.name for r in rules if any(path.fullmatch(str(o)) for o in r.output)]
        readers = [
            r.name
            for r in rules
            if r.script
            and any(
                getattr(i, "reads", None) == file.name
                or (isinstance(i, str) and path.fullmatch(str(i)))
                for i in r.input
            )
        ]
        cells = [f"`{file.name}`", f"`{file.path}`", file.sentence]
        cells += [", ".join(f"`{name}`" for name in sorted(names)) for names in (writers, readers)]
        text += f"| {' | '.join(cells)} |\n"
    text += COLUMNS
    for file in RESULT_FILES.values():
        if file.columns:
            text += f"| `{file.path}` | {', '.join(f'`{c}`' for c in file.columns)} |\n"
        if file.columns_of_materials:
            columns = ", ".join(f"`{c}`" for c in file.columns_of_materials)
            text += f"| `{file.path}` of several materials | {columns} |\n"
    text += ALL_MODELS
    for file in TABLES_OF_ALL_MODELS:
        columns = ", ".join(f"`{column}`" for column in file.columns)
        text += f"| `{file.path}` | {file.sentence} | {columns} |\n"
    return text


if __name__ == "__main__":
    PAGE.write_text(render_page(load_rules()), encoding="utf-8")
