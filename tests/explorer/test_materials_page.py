"""The page of several materials shows the facets of the mesh, and each material can be hidden."""

import shlex

import numpy as np
import pandas as pd
import pytest
from test_browser import ATTACK, Opened, browser  # noqa: F401

import tusqh
from tusqh.errors import ConfigError
from tusqh.explorer.arrays import CUT_ELEMENTS
from tusqh.explorer.materials import make_materials_page, read_materials_subject
from tusqh.figures.material_colours import (
    MOST,
    VOID_COLOUR,
    colours_of,
    material_colours,
    to_oklab,
    to_rgb,
)
from tusqh.figures.theme import PALETTE

NAMES = {1: ATTACK, 2: "7", 3: "skin"}


@pytest.fixture(scope="module", params=[(7, 6), (5, 4, 4)], ids=["plane", "space"])
def folder(request, tmp_path_factory):
    """Results of noise of three labels, which has contacts everywhere."""
    image = np.random.default_rng(1).integers(0, 4, request.param)
    folder = tmp_path_factory.mktemp("results") / "noise"
    tusqh.mesh(image, materials=NAMES, name="noise").save(folder)
    return folder


@pytest.fixture(scope="module")
def opened(browser, folder, tmp_path_factory):  # noqa: F811
    path = tmp_path_factory.mktemp("page") / "materials.html"
    path.write_text(make_materials_page(read_materials_subject(folder)), "utf-8")
    opened = Opened(browser, path)
    yield opened
    assert opened.messages == []
    assert opened.requests == [path.as_uri()]
    opened.page.close()


def expected_facets(subject, shown):
    """Return the boundary of the shown materials, facets with colours, by brute force."""
    mesh, material = subject.mesh, subject.regions.material
    colours = colours_of(subject.regions.names)
    points = np.round((mesh.points - subject.grid.origin) / subject.grid.cell_size, 3)
    if mesh.dim == 2:
        return {
            (frozenset(map(tuple, points[cell])), colours[k])
            for cell, k in zip(mesh.cells.tolist(), material.tolist(), strict=True)
            if k in shown
        }
    sides = {}
    for corners, cell in zip(mesh.facets.corners.tolist(), mesh.facets.cell.tolist(), strict=True):
        if material[cell] in shown:
            sides.setdefault(frozenset(corners), []).append(material[cell])
    return {
        (frozenset(map(tuple, points[list(corners)])), colours[owners[0]])
        for corners, owners in sides.items()
        if len(owners) == 1
    }


def drawn_facets(opened, dim):
    places, tints = opened.evaluate(
        """() => { const { count, object } = explorer.layer;
        const { place, tint } = object.geometry.attributes;
        return [place, tint].map(({ array }) => Array.from(array.slice(0, 12 * count))); }"""
    )
    places = np.round(np.array(places).reshape(-1, 4, 3)[..., :dim], 3)
    tints = np.array(tints, dtype=int).reshape(-1, 4, 3)[:, 0]
    found = [
        (frozenset(map(tuple, place.tolist())), "#{:02x}{:02x}{:02x}".format(*tint))
        for place, tint in zip(places, tints, strict=True)
    ]
    assert len(set(found)) == len(found)
    return set(found)


def test_what_is_shown_is_the_boundary_of_the_materials_that_are_ticked(opened, folder):
    subject = read_materials_subject(folder)
    boxes = opened.page.locator("#legend input")
    assert boxes.count() == 3
    for shown in ([0, 1, 2], [1, 2], [2], [0]):
        for k in range(3):
            boxes.nth(k).set_checked(k in shown)
        assert drawn_facets(opened, subject.grid.dim) == expected_facets(subject, shown)
    opened.page.click("#hide-all")
    assert drawn_facets(opened, subject.grid.dim) == set()
    opened.page.click("#show-all")
    assert drawn_facets(opened, subject.grid.dim) == expected_facets(subject, [0, 1, 2])


def test_names_numbers_and_verdicts_are_those_of_the_tables(opened, folder):
    table = pd.read_csv(folder / "materials.csv", dtype=str)
    alone = table[table["material"] != "all"]
    names = (alone["material"] + " (" + alone["elements"] + ")").tolist()
    assert opened.page.locator("#legend li").all_inner_texts() == names
    rows = opened.page.locator("#panel-materials tbody tr")
    assert rows.count() == 4
    for row, (_, expected) in zip(rows.all(), table.iterrows(), strict=True):
        text = row.inner_text()
        betti = ", ".join(expected[f"betti_{k}_measured"] for k in range(3))
        assert expected["material"] in text
        assert betti in text
        assert "suitable" in text
    assert opened.evaluate("document.title") == "noise - tusqh explorer"  # The attack failed.
    assert opened.page.locator("#slider").count() == 0
    opened.page.click("#tab-quality")
    assert "Checks of the mesh and of each material" in opened.text("#panel-quality")


def test_colours_change_with_the_mode_and_a_cut_leaves_whole_layers(opened, folder):
    opened.page.select_option("#colour", "quality")
    assert "scaled Jacobian" in opened.text("#scale")
    opened.page.select_option("#colour", "plain")
    assert opened.text("#scale") == ""
    subject = read_materials_subject(folder)
    if subject.grid.dim == 2:
        assert not opened.page.is_visible("#cut-axis")
        return
    whole = len(drawn_facets(opened, 3))
    opened.page.select_option("#cut-axis", "0")
    opened.evaluate("document.getElementById('cut-at').value = 2; explorer.setCut()")
    layer = subject.mesh.grid_cell // (4 * 4)
    part = subject.mesh.take(np.flatnonzero(layer < 2), name="part")
    assert len(drawn_facets(opened, 3)) == len(part.facets.boundary) < whole
    opened.page.select_option("#cut-axis", "")
    assert len(drawn_facets(opened, 3)) == whole


def test_curves_are_the_edges_of_elements_of_three_materials(opened, folder):
    """Compare with the materials of all elements at every edge, and the outside at the boundary."""
    subject = read_materials_subject(folder)
    mesh, material = subject.mesh, subject.regions.material
    shown = opened.evaluate(
        """() => { const { curves } = explorer; const before = curves.visible;
        document.getElementById('curves').click();
        return [before, curves.visible, Array.from(curves.geometry.index.array)]; }"""
    )
    assert shown[:2] == [False, True]
    found = {frozenset(edge) for edge in np.array(shown[2], dtype=int).reshape(-1, 2).tolist()}
    if mesh.dim == 2:
        assert found == set()
        return
    at = {}
    for cell, k in zip(mesh.cells, material.tolist(), strict=True):
        for a, b in [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4),
                     (1, 5), (2, 6), (3, 7)]:  # fmt: skip
            at.setdefault(frozenset((int(cell[a]), int(cell[b]))), set()).add(k)
    for side in mesh.facets.boundary.tolist():
        for a, b in zip(side, side[1:] + side[:1], strict=True):
            at[frozenset((a, b))].add("outside")
    expected = {edge for edge, materials in at.items() if len(materials) > 2}
    assert found == expected
    assert len(found) > 20


def test_large_meshes_keep_the_facets_between_materials(folder, monkeypatch):
    subject = read_materials_subject(folder)
    if subject.grid.dim == 2:
        return
    from tusqh.explorer.arrays import mesh_arrays

    assert subject.mesh.n_cells < CUT_ELEMENTS
    monkeypatch.setattr("tusqh.explorer.arrays.CUT_ELEMENTS", 1)
    material = subject.regions.material
    arrays = mesh_arrays(subject.mesh, subject.grid, material)
    first = np.cumsum(arrays["first"])
    second = first + arrays["second"]
    is_inner = first != second
    assert (material[first[is_inner]] != material[second[is_inner]]).all()
    assert (~is_inner).sum() == len(subject.mesh.facets.boundary)
    interfaces = {frozenset(pair) for pair in zip(material[first], material[second], strict=True)}
    assert len(interfaces) == 6  # Three materials by themselves, at the boundary, and three pairs.


def test_missing_files_are_named(folder, tmp_path):
    (tmp_path / "materials.csv").write_text("material\n")
    with pytest.raises(ConfigError, match=r"mesh.vtu.* missing"):
        read_materials_subject(tmp_path)


def test_colours_can_be_told_apart():
    """Compare all pairs in OKLab, in which the just noticeable difference is about 0.02."""
    for n in (2, 8, 21, 64, MOST):
        lab = to_oklab(to_rgb(material_colours(n, has_void=True)))
        distance = np.linalg.norm(lab[:, None] - lab, axis=2) + np.eye(n)
        assert distance.min() > (0.1 if n <= 8 else 0.06 if n <= 64 else 0.045)
        assert lab[:, 0].min() > 0.5
    assert material_colours(MOST + 2)[-2:] == material_colours(2)
    assert material_colours(1, has_void=True) == [VOID_COLOUR]
    names = [*(f"county {k}" for k in range(94)), "water", "void"]
    colours = colours_of(names)
    assert len({*colours}) == len(names)
    assert colours[-2:] == [PALETTE[0], VOID_COLOUR]


def test_an_offer_shows_its_cells_and_makes_the_command(opened, folder):
    subject = read_materials_subject(folder)
    prices = pd.read_csv(folder / "prices.csv", dtype={"material": str})
    offers = opened.evaluate("explorer.wishes.offers.map((offer) => offer)")
    facts = opened.evaluate("explorer.facts.classes")
    assert len(offers) == len(prices) > 5
    opened.page.click("#tab-features")
    n_shown = 0
    for k, (offer, price) in enumerate(zip(offers, prices.to_dict("records"), strict=True)):
        about = facts[offer["pair"]]
        assert (about["material"], about["row"], offer["do"]) == tuple(
            price[key] for key in ("material", "row", "do")
        )
        assert (offer["why"] == "") == price["possible"]
        button = opened.page.locator(f"#panel-features [data-wish='{k}']")
        assert button.count() == price["possible"]
        if not price["possible"] or n_shown > 3:
            continue
        n_shown += 1
        button.click()
        assert opened.evaluate(f"explorer.wishes.cells({k}).length") == price["cells"]
        assert opened.evaluate("explorer.cellBoxes.object.children.length") == 1
        note = opened.text("#note")
        assert f"{int(price['cells'])} cell" in note
        assert price["volumes"] in note
        words = shlex.split(opened.text("#command"))
        at = words.index(f"--{price['do']}")
        assert words[at + 1] == f"{price['material']}:{price['row']}"
        features = [{key: price[key] for key in ("material", "row", "do")}]
        local = tusqh.mesh(subject.fractions, materials="parts", features=features).local
        changed = np.flatnonzero(local.labels != local.base)
        shown = opened.evaluate(f"Array.from(explorer.wishes.cells({k}))")
        assert set(changed.tolist()) <= set(shown)
        button.click()
        assert not opened.page.is_visible("#note")
        assert f"--{price['do']}" not in opened.text("#command")
    assert n_shown > 2
