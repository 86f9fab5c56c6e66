"""`tusqh view` makes a page from a geometry or a result folder, with or without a browser."""

import json
import re
import sys

import pytest

from tusqh.cli.app import main

# A square with a round hole; its border is open in one place.
PLATE = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 40 40">
  <path d="M 0 0 H 40 V 40 H 0 V 0.5
    M 30 20 A 10 10 0 1 0 10 20 A 10 10 0 1 0 30 20 Z"/>
</svg>
"""


@pytest.fixture
def run(tmp_path, capfd, monkeypatch):
    """Run `tusqh` in a folder with a plate; return exit code, output, errors, pages opened."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tusqh.cli.app.catch_signals", lambda: None)
    (tmp_path / "plate.svg").write_text(PLATE)
    opened = []

    def run(*arguments, browser=True):
        monkeypatch.setattr("webbrowser.open", lambda url: opened.append(url) or browser)
        monkeypatch.setattr(sys, "argv", ["tusqh", *map(str, arguments)])
        opened.clear()
        try:
            main()
            code = 0
        except SystemExit as end:
            code = end.code
        return code, *capfd.readouterr(), list(opened)

    return run


def facts_of(page):
    text = page.read_text(encoding="utf-8")
    return json.loads(re.search(r'id="facts-json">(.*?)</script>', text, re.DOTALL)[1])


def test_a_geometry_is_meshed_shown_and_opened(run, tmp_path):
    code, out, _, opened = run("view", "plate.svg", "--cells", 16, "--betti", "1,1", "--unit", "mm")
    assert code == 0
    assert "plate.html (0." in out
    assert opened == [(tmp_path / "plate.html").as_uri()]
    facts = facts_of(tmp_path / "plate.html")
    assert facts["name"] == "plate"
    assert facts["unit"] == "mm"
    assert facts["command"]["before"] == "tusqh mesh plate.svg --cells 16 --unit mm"
    assert dict(facts["head"])["its Betti numbers"] == "1, 1"
    assert facts["verdict"].startswith("suitable")


def test_the_page_says_where_it_is_without_a_browser(run, tmp_path):
    code, out, _, opened = run("view", "plate.svg", "--cells", 8, browser=False)
    assert code == 0
    assert len(opened) == 1
    assert "no browser was found: open that file in one" in out
    code, out, _, opened = run("view", "plate.svg", "--cells", 8, "--no-open", "-o", "a b/c.html")
    assert (code, opened) == (0, [])
    assert "a b/c.html" in out
    assert (tmp_path / "a b/c.html").read_bytes() == (tmp_path / "plate.html").read_bytes()


def test_a_result_folder_is_shown_as_it_is(run, tmp_path):
    assert run("mesh", "plate.svg", "--cells", 12, "--results", "out/plate")[0] == 0
    before = sorted((tmp_path / "out/plate").iterdir())
    code, _, _, opened = run("view", "out/plate")
    page = tmp_path / "out/plate/view.html"
    assert code == 0
    assert opened == [page.as_uri()]
    assert sorted((tmp_path / "out/plate").iterdir()) == sorted([*before, page])
    facts = facts_of(page)
    assert facts["command"]["before"].startswith("tusqh mesh plate.svg --cells 12,")
    assert "--placement corner" in facts["command"]["before"]
    assert facts["command"]["note"] == "unit, domain, rule and orientation are not known here"
    # The command that the page shows makes the mesh that the page shows.
    words = f"{facts['command']['before']} --threshold {facts['chosen']['threshold']}".split()
    assert run(*words[1:], "-o", "again.vtu")[0] == 0
    ours = (tmp_path / "out/plate/mesh.vtu").read_bytes()
    assert (tmp_path / "again.vtu").read_bytes() == ours


def test_the_page_of_the_workflow_is_opened_while_it_is_up_to_date(run, tmp_path):
    run("mesh", "plate.svg", "--cells", 8, "--results", "out")
    made = tmp_path / "out/explorer.html"
    made.write_text("made by the workflow")
    assert run("view", "out")[3] == [made.as_uri()]
    assert not (tmp_path / "out/view.html").exists()
    (tmp_path / "out/mesh.vtu").touch()
    assert run("view", "out")[3] == [(tmp_path / "out/view.html").as_uri()]
    assert made.read_text() == "made by the workflow"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["nothing.svg"], "nothing.svg"),
        (["."], "geometry.vtp, fractions.npz"),
        (["plate.svg", "-o", "plate.svg/page.html"], "cannot be written"),
        (["plate.svg", "--cells", "8", "--betti", "7,0"], "betti_0 = 7"),
    ],
)
def test_what_cannot_be_shown_is_a_message_and_no_page(run, tmp_path, arguments, message):
    code, _, error, opened = run("view", *arguments)
    assert code == 2
    assert message in error
    assert "Traceback" not in error
    assert opened == []
    assert not list(tmp_path.rglob("*.html"))


def test_a_name_that_attacks_is_only_text(run, tmp_path):
    name = "<script>alert(1)<!--.svg"
    (tmp_path / name).write_text(PLATE)
    assert run("view", name, "--cells", 8, "--no-open", "-o", "page.html")[0] == 0
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert "<script>alert" not in text
    assert facts_of(tmp_path / "page.html")["name"] == name.removesuffix(".svg")
