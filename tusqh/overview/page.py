"""Render the overview from a template, with escaped text, tables and relative links."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any
from urllib.parse import quote

import jinja2
import pandas as pd

from tusqh.overview.model import ModelEntry

#: Longer tables are truncated on the page and link to the whole file.
MAX_ROWS = 60


def render_overview(
    page: Path,
    models: Sequence[ModelEntry],
    *,
    tables: Mapping[str, Path],
    figures: Mapping[str, Path],
    captions: Mapping[str, str],
) -> str:
    """Return the overview as one HTML page.

    Parameters
    ----------
    page
        Future path of the page; links are relative to its folder.
    models
        The models, in the order in which they are shown.
    tables
        Tables on all models, by title.
    figures
        Pictures on all models, by title.
    captions
        Captions of pictures, by the file name without suffix.

    Returns
    -------
    str
        The page, which refers only to files of the results.
    """
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters["cells"] = _to_cells

    def link(path: Path) -> str:
        return quote(Path(os.path.relpath(path, page.parent)).as_posix())

    return environment.from_string(_read_template()).render(
        models=models,
        tables={title: (path, pd.read_csv(path)) for title, path in tables.items()},
        figures=figures,
        captions=captions,
        link=link,
        max_rows=MAX_ROWS,
    )


def _read_template() -> str:
    return resources.files("tusqh.overview").joinpath("overview.html.j2").read_text("utf-8")


def _to_cells(table: pd.DataFrame) -> list[list[str]]:
    """Return the first rows of a table as text."""
    return [[_to_text(v) for v in row] for row in table.head(MAX_ROWS).itertuples(index=False)]


def _to_text(value: Any) -> str:
    if isinstance(value, float):
        return "" if math.isnan(value) else f"{value:.6g}"
    return str(value)
