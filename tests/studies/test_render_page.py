"""Templates of pages can use some tables and figures and cannot use others."""

import re
from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd
import pytest

from provenance.stamp import read_mark, stamp
from studies.pictures import copy_pictures, picture_name
from studies.render_page import render_page
from tusqh.errors import TusqhError


@pytest.fixture
def folder(tmp_path):
    pd.DataFrame({"model": ["cow", "bunny"], "cells": [12, 34567], "error": [0.5, 1e-7]}).to_csv(
        tmp_path / "t.csv", index=False
    )
    figure, axes = plt.subplots(figsize=(4, 2), dpi=500)
    axes.plot([0, 1])
    (tmp_path / "results/cow/figures").mkdir(parents=True)
    figure.savefig(tmp_path / "results/cow/figures/a.png")
    plt.close(figure)
    return tmp_path


def render(folder, text, **given):
    (folder / "page.md.j2").write_text(text)
    given = {"tables": [str(folder / "t.csv")], "figures": []} | given
    return render_page(folder / "page.md.j2", **given)


def test_values_and_tables_come_from_the_files(folder):
    path = folder / "t.csv"
    text = f"""{{{{ value("{path}", "cells", "model == 'bunny'") }}}}
{{{{ table("{path}", columns=["model", "error"], rows="cells < 99", names={{"error": "e [-]"}}) }}}}
"""
    lines = render(folder, text).splitlines()
    assert lines[0] == "34567"
    assert [cell.strip() for cell in lines[1].strip("|").split("|")] == ["model", "e [-]"]
    assert [cell.strip() for cell in lines[3].strip("|").split("|")] == ["cow", "0.5"]
    assert len(lines) == 4


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{{ value('t.csv', 'cells') }}", "t.csv is not an input"),
        ("{{ value(PATH, 'cells') }}", "2 different values"),
        ("{{ table(PATH, columns=['size']) }}", "no column size"),
        ("{{ figure('x.png', 'x') }}", "x.png is not an input"),
        ("{{ unknown }}", "does not render"),
        ("{% if %}", "does not render"),
    ],
)
def test_a_page_cannot_quote_what_is_not_there(folder, text, message):
    with pytest.raises(TusqhError, match=re.escape(message)):
        render(folder, text.replace("PATH", f"'{folder / 't.csv'}'"))


def test_a_page_must_show_its_figures(folder):
    figure = "results/cow/figures/a.png"
    with pytest.raises(TusqhError, match="does not show"):
        render(folder, "nothing", figures=[figure])
    text = render(folder, f"{{{{ figure('{figure}', 'A cow.') }}}}", figures=[figure])
    assert text == "![A cow.](images/results/cow_a.png)\n\n*A cow.*\n"


def test_pictures_are_small_copies_and_the_same_bytes_each_time(folder, monkeypatch):
    from PIL import Image

    monkeypatch.chdir(folder)
    figure = "results/cow/figures/a.png"
    mark = {"step": "figure_cow", "file": figure}
    stamp(Path(figure), mark)
    (first,) = copy_pictures([figure], folder / "one")
    (second,) = copy_pictures([figure], folder / "two")
    assert first.name == picture_name(figure)
    assert first.read_bytes() == second.read_bytes()
    assert Image.open(figure).size == (2000, 1000)
    assert Image.open(first).size == (1400, 700)
    assert read_mark(first) == mark, "a copy leads back to the figure"
