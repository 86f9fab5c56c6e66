"""The committed page of results is complete and agrees with the locked tables."""

import json
import re

import pytest

from tusqh.hashing import hash_file

PAGE, LOCK = "docs/results.md", "results/lock.json"


@pytest.fixture(scope="module")
def page(repository):
    return (repository / PAGE).read_text()


def test_every_figure_of_the_paper_is_listed(repository):
    text = (repository / "workflow/report/results/figures.md.j2").read_text()
    rows = re.findall(r"^\| (\d+) \| (.+?) \| (.+?) \|$", text, flags=re.MULTILINE)
    assert [int(number) for number, _, _ in rows] == list(range(1, 26))
    assert all("link(" in counterpart for _, _, counterpart in rows)


def test_every_linked_figure_is_on_the_page(page):
    section = page[page.index("## Every figure of the paper") :]
    assert "`results/" not in re.sub(r"\[`[^`]+`\]", "", section)


def test_its_pictures_are_there(repository, page):
    pictures = set(re.findall(r"\((images/results/[^)]+)\)", page))
    assert len(pictures) > 20
    for picture in pictures:
        content = (repository / "docs" / picture).read_bytes()
        assert content.startswith(b"\x89PNG"), picture
    on_disk = {f"images/results/{p.name}" for p in (repository / "docs/images/results").iterdir()}
    assert on_disk == pictures


def test_nothing_is_left_of_the_template(page):
    assert not re.search(r"\{\{|\}\}|\{%|%\}|\bnan\b|Undefined", page)


def test_it_is_what_the_workflow_made(repository):
    """The lock holds the hash of the page that the locked run made."""
    if not (repository / LOCK).is_file():
        pytest.fail("there is no lock: tusqh lock")
    entry = re.search(
        r'"results/page/results\.md".{0,200}?"([0-9a-f]{64})"',
        json.dumps(json.loads((repository / LOCK).read_text())),
    )
    if entry is None:
        pytest.fail("the lock does not hold the page: snakemake --cores 2, then tusqh lock")
    assert hash_file(repository / PAGE) == entry.group(1)
