"""Render pages from templates, tables and figures.

A template is Jinja2 text.  It can use the tables and figures that are inputs of the page::

    {{ value("results/tables/summary.csv", "elements", "model == 'bearings'") }}
    {{ table("results/tables/summary.csv", columns=["model", "verdict"], rows="cells > 100") }}
    {{ figure("results/bearings/figures/panels.png", "Meshes of the bearing.") }}
    {{ link("results/bearings/figures/panels.png") }}
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import jinja2
import numpy as np
import pandas as pd

from studies.pictures import picture_name
from tusqh.errors import TusqhError


class PageError(TusqhError):
    """A template is broken, or uses a table or figure that is not an input."""


def render_page(
    template: Path,
    *,
    tables: Iterable[str],
    figures: Iterable[str],
    pictures: str = "images/results",
) -> str:
    """Return the Markdown text of a page.

    Parameters
    ----------
    template
        The Jinja2 template; the files that it includes are in the same folder.
    tables
        CSV files that it can use.
    figures
        PNG files, all of which it must show.
    pictures
        Folder of the pictures, relative to the page.

    Raises
    ------
    PageError
        The template is broken, uses a file that is not an input or a value that is not unique, or
        omits a figure.
    """
    given = {path: pd.read_csv(path) for path in tables}
    allowed, shown = set(figures), set()

    def figure(path: str, caption: str) -> str:
        _require(path in allowed, f"the figure {path} is not an input", template)
        shown.add(path)
        return f"![{caption}]({pictures}/{picture_name(path)})\n\n*{caption}*"

    def link(path: str) -> str:
        if path in allowed:
            return f"[`{path}`]({pictures}/{picture_name(path)})"
        return f"`{path}`"

    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(template.parent),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,
    )
    functions: dict[str, Callable[..., Any]] = {
        "figure": figure,
        "link": link,
        "table": lambda path, **how: _to_markdown(_rows(given, path, template, **how)),
        "value": lambda path, column, rows=None: _one(
            _rows(given, path, template, columns=[column], rows=rows), path, template
        ),
        "count": lambda path, rows=None: len(_rows(given, path, template, rows=rows)),
        "rows": lambda path, **how: _rows(given, path, template, **how).to_dict("records"),
        "has": lambda path: path in given or path in allowed,
    }
    try:
        text = environment.get_template(template.name).render(**functions)
    except jinja2.TemplateError as reason:
        raise PageError(
            f"the template does not render: {reason}",
            where=str(template),
            expected="Jinja2 text that uses table, value, rows, figure and has",
            remedy="correct the template",
        ) from reason
    missing = sorted(allowed - shown)
    _require(not missing, f"the page does not show {', '.join(missing)}", template)
    return text.rstrip() + "\n"


def _rows(
    given: dict[str, pd.DataFrame],
    path: str,
    template: Path,
    *,
    columns: Sequence[str] | None = None,
    rows: str | None = None,
    names: dict[str, str] | None = None,
) -> pd.DataFrame:
    """Return some rows (a pandas query) and renamed columns of a table."""
    _require(path in given, f"the table {path} is not an input", template)
    found = given[path] if rows is None else given[path].query(rows)
    if columns is not None:
        unknown = sorted(set(columns) - set(found.columns))
        _require(not unknown, f"{path} has no column {', '.join(unknown)}", template)
        found = found[list(columns)]
    return found.rename(columns=names or {})


def _one(found: pd.DataFrame, path: str, template: Path) -> str:
    """Return the only value of a table with one column."""
    values = found.iloc[:, 0].drop_duplicates()
    _require(len(values) == 1, f"{len(values)} different values in {path} instead of one", template)
    return _show(values.iloc[0])


def _to_markdown(found: pd.DataFrame) -> str:
    shown = found.map(_show)
    return shown.to_markdown(index=False, disable_numparse=True)


def _show(value: Any) -> str:
    """Return a value as text with at most four significant digits; empty if it is missing.

    >>> [_show(value) for value in (0.123456, 12345, 1234567.8, True, float("nan"), "raw")]
    ['0.1235', '12345', '1.235e+06', 'yes', '', 'raw']
    """
    if isinstance(value, bool | np.bool_):
        return "yes" if value else "no"
    if value is None or (isinstance(value, float | np.floating) and np.isnan(value)):
        return ""
    return f"{value:.4g}" if isinstance(value, float | np.floating) else str(value)


def _require(holds: bool, found: str, template: Path) -> None:
    if not holds:
        raise PageError(
            found,
            where=str(template),
            expected="a page that uses the inputs of its rule, and all of its figures",
            remedy="list the file in workflow/rules/results.smk, or correct the template",
        )
