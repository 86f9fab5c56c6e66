"""The overview shows the content of the tables, links to existing files, and escapes all text."""

import hashlib
import json
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
import pandas as pd
import pytest

import tusqh
from tusqh.overview.materials import read_materials_model
from tusqh.overview.model import read_model
from tusqh.overview.page import MAX_ROWS, render_overview

NASTY = '<script>alert("1")</script>&\'"'


class Parts(HTMLParser):
    """Tags, links, images and text of a page."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.links, self.images, self.text = [], [], [], []
        self.feed(text)
        self.text = " ".join(" ".join(self.text).split())

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        attributes = dict(attributes)
        if tag == "a":
            self.links.append(attributes["href"])
        if tag == "img":
            self.images.append(attributes["src"])
        assert not [name for name in attributes if name.startswith("on")]

    def handle_data(self, data):
        self.text.append(data)


def write_model(
    folder: Path, name: str, *, holds: bool = True, verdict: str = "yes", n_rows: int = 3
) -> dict[str, Any]:
    """Write the files of a model in which every text that users choose is nasty."""
    folder.mkdir(parents=True)
    certificate = {
        "model": name,
        "tusqh": "0.1.0",
        "holds": holds,
        "selection": {
            **{"wanted": NASTY, "threshold": 0.5, "margin": 0.1, "reason": NASTY},
            **{"lower": 0.4, "upper": 0.6, "cells_lower": 0.45, "cells_upper": 0.5},
        },
        "predicted": {"effective": [1, 2, 0]},
        "measured": {"euler": [1, 2, 0]},
        "fractions": {"file": "fractions.npz", "sha256": "f" * 64},
        "mesh": {"file": "mesh.vtu", "sha256": "a" * 64},
    }
    facts = {"dimension": 3, "elements": 12345, "grid": "4x4x4", "contacts": 7, "overruled": 0}
    facts |= {"volume": 3.0, "reference_volume": 4.0, "reference_source": "the exact volume"}
    reading = {"kind": "surface", "format": "STL", "closed": False, "box": [[0, 0, 0], [1, 2, 3]]}
    reading |= {"counts": {"parts": 1, "triangles": 9, "points": 7, "boundary_edges": 9}}
    reading |= {"unit": {"name": NASTY, "source": "file"}}
    reading |= {"remarks": [{"effect": "left out", "what": NASTY, "count": 2, "remedy": NASTY}]}
    (folder / "reading.json").write_text(json.dumps(reading))
    (folder / "certificate.json").write_text(json.dumps(certificate))
    (folder / "facts.json").write_text(json.dumps(facts))
    geometry = folder / "<b>'&.stl"
    geometry.write_bytes(b"solid")
    tables = {
        "defects": {"defect": ["boundary_edges"], "count": [9], "explanation": [NASTY]},
        "candidates": {"rank": [1], "threshold": [0.5]},
        "verdict": {"name": [NASTY], "found": [1], "required": [1], "holds": [verdict]},
        "verification": {"threshold": [k / 1000 for k in range(n_rows)], "holds": [holds] * n_rows},
    }
    for title, table in tables.items():
        pd.DataFrame(table).to_csv(folder / f"{title}.csv", index=False)
    (folder / "a picture#1.png").write_bytes(b"")
    return {
        "folder": folder,
        "geometry": str(geometry),
        "figures": [folder / "a picture#1.png"],
        "links": {"mesh & more": folder / "facts.json"},
    }


def save_grains(folder: Path) -> dict[str, Any]:
    """Save a mesh of two materials, one of which has a nasty name, and a picture."""
    image = np.zeros((6, 6, 6), dtype=np.uint8)
    image[1:5, 1:5, 1:5], image[2:4, 2:4, 2:4] = 1, 2
    tusqh.mesh(image, materials={1: NASTY, 2: "7"}, name="grains").save(folder)
    np.save(folder / "a.npy", image)
    (folder / "p.png").write_bytes(b"")
    links = {"mesh (VTU)": folder / "mesh.vtu"}
    return {
        "folder": folder,
        "geometries": [str(folder / "a.npy")],
        "figures": [folder / "p.png"],
        "links": links,
    }


@pytest.fixture
def overview(tmp_path):
    """Render a page over models in tmp_path/results and return its parts."""

    def render(*files, register=None):
        results = tmp_path / "results"
        page = results / "report/index.html"
        page.parent.mkdir(parents=True, exist_ok=True)
        summary = results / "summary.csv"
        pd.DataFrame({"model": [NASTY], "volume": [0.123456789]}).to_csv(summary, index=False)
        text = render_overview(
            page,
            [
                (read_model if "geometry" in of_model else read_materials_model)(
                    **of_model, register=register
                )
                for of_model in files
            ],
            tables={"summary": summary},
            figures={"all pinches": results / "pinches.png"},
            captions={"pinches": f"caption {NASTY}"},
        )
        page.write_text(text)
        return page, Parts(text)

    return render


def test_what_it_shows(overview, tmp_path):
    register = pd.DataFrame(
        {
            "model": ["ring"],
            "file": ["data/ring.stl"],
            "sha256": ["b" * 64],
            "origin": ["drawn"],
            "licence": [NASTY],
            "url": [None],
            "known_defects": ["none"],
        }
    )
    files = write_model(tmp_path / "results/ring", "ring")
    _, parts = overview(files, register=register)
    assert hashlib.sha256(b"solid").hexdigest() in parts.text
    for text in (
        "1 of 1 models",
        "Betti numbers (1, 2, 0)",
        "12,345 hexes of 4x4x4 cells",
        "0.7500 of the exact volume",
        "suitable",
        "3 of 3 as predicted",
        "boundary_edges",
        "0.123457",
        "b" * 64,
        "drawn",
    ):
        assert text in parts.text, text


def test_links_are_relative_and_lead_to_files(overview, tmp_path):
    page, parts = overview(write_model(tmp_path / "results/ring", "ring"))
    (tmp_path / "results/pinches.png").write_bytes(b"")
    local = [link for link in parts.links + parts.images if not link.startswith("#")]
    assert len(local) == 7
    for link in local:
        assert not link.startswith(("/", "http"))
        assert (page.parent / unquote(link)).is_file(), link
    assert "#model-ring" in parts.links


def test_names_and_texts_are_escaped(overview, tmp_path):
    _, parts = overview(write_model(tmp_path / "results/ring", NASTY))
    assert not {"script", "b"} & set(parts.tags)
    assert "<b>'&.stl" in parts.text
    assert parts.text.count(NASTY) >= 6


def test_failures_are_counted_and_named(overview, tmp_path):
    files = [write_model(tmp_path / f"results/{name}", name, holds=name == "a") for name in "ab"]
    page, parts = overview(*files)
    assert "1 of 2 models" in parts.text
    assert page.read_text().count('class="fails"') == 2


def test_warnings_are_counted_and_shown(overview, tmp_path):
    verdicts = {"a": "yes", "b": "warning", "c": "no"}
    files = [write_model(tmp_path / f"results/{k}", k, verdict=v) for k, v in verdicts.items()]
    page, parts = overview(*files)
    assert "2 of 3 models" in "".join(parts.text)
    assert "1 of them has warnings" in "".join(parts.text)
    assert page.read_text().count('<li class="warned">') == 1


def test_long_tables_are_cut_and_say_so(overview, tmp_path):
    _, parts = overview(write_model(tmp_path / "results/ring", "ring", n_rows=MAX_ROWS + 5))
    assert f"{MAX_ROWS} of {MAX_ROWS + 5} rows" in parts.text
    assert parts.tags.count("tr") < MAX_ROWS + 20


def test_models_of_several_materials_count_and_fail_as_others_do(overview, tmp_path):
    ring = write_model(tmp_path / "results/ring", "ring")
    grains = save_grains(tmp_path / "results/grains")
    page, parts = overview(ring, grains)
    assert "2 of 2 models" in parts.text
    for text in (
        f"2: {NASTY}, 7",
        "all together have the Betti numbers (1, 0, 0)",
        "Betti numbers (1, 0, 0) of all together, and 2 of 2 materials as predicted",
        "64 hexes of 6x6x6 cells",
        "volume 1.0000 of the volume fractions",
        "Materials, and all of them together: 3 rows",
        "(1, 0, 1)",
        hashlib.sha256(Path(grains["geometries"][0]).read_bytes()).hexdigest(),
    ):
        assert text in parts.text, text
    assert "script" not in parts.tags
    for link in parts.links + parts.images:
        target = page.parent / unquote(link)
        assert link.startswith("#") or target.is_file() or "pinches" in link, link
    # A failed check of one material is a failure of the model, and the table says of which.
    verdict = pd.read_csv(tmp_path / "results/grains/verdict.csv", dtype=str)
    verdict.loc[verdict["id"] == "manifold_7", "holds"] = "no"
    verdict.to_csv(tmp_path / "results/grains/verdict.csv", index=False)
    entry = read_materials_model(**grains)
    assert not entry.holds
    verdicts = entry.tables["Materials, and all of them together"].set_index("material")["verdict"]
    assert verdicts.to_dict() == {
        NASTY: "suitable",
        "7": "not suitable: 1 check fails",
        "all": "not suitable: 1 check fails",
    }
