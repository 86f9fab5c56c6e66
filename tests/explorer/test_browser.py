"""Explorers opened from disk in a browser show what the library computes."""

import json
import shlex
from dataclasses import replace

import numpy as np
import pytest
from needs import find_browser
from playwright.sync_api import sync_playwright
from subjects import keys_of, make_subject, noise

from tusqh.antialias.cells import CellSets
from tusqh.explorer.distances import NONE, as_colours, boundary_distances
from tusqh.explorer.page import make_page
from tusqh.geometry.image import Image
from tusqh.grid import BackgroundGrid
from tusqh.local_topology.features import Features
from tusqh.local_topology.prices import tabulate_prices
from tusqh.meshes.volume_mesh import KINDS
from tusqh.sampling.fractions import VolumeFractions
from tusqh.settings.arguments import from_options
from tusqh.settings.model import Settings
from tusqh.settings.policy import Policy
from tusqh.threshold.choose import choose_threshold
from tusqh.threshold.plateaus import BETTI, Plateaus
from tusqh.topology.persistence import count_alive

#: These make WebGL work without a graphics card, and prevent network access of the browser.
FLAGS = [
    *("--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader"),
    *("--enable-unsafe-swiftshader", "--disable-background-networking", "--no-first-run"),
    *("--disable-component-update", "--disable-sync"),
]
POLICIES = {
    "plane": {"components": {"min_cells": 3}, "holes": {"min_cells": 2}},
    "space": {"components": {"min_cells": 4}, "voids": {"min_cells": 2}},
}
SHAPES = {"plane": (9, 7), "space": (6, 5, 7)}
ATTACK = "</script><script>document.title = 'taken'</script><img src=x onerror=alert(1)>"


@pytest.fixture(scope="module")
def browser():
    path = find_browser()
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=path, args=FLAGS)
        yield opened
        opened.close()


class Opened:
    """A page with all its errors."""

    def __init__(self, browser, path):
        self.page = browser.new_page(viewport={"width": 1280, "height": 800})
        self.messages, self.requests = [], []
        self.page.on("console", lambda message: self.messages.append(message.text))
        self.page.on("pageerror", lambda error: self.messages.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.goto(path.as_uri())
        self.page.wait_for_selector("body[data-ready]")

    def evaluate(self, script, argument=None):
        return self.page.evaluate(script, argument)

    def text(self, selector):
        return self.page.inner_text(selector)

    def betti(self):
        return [int(b.replace(",", "")) for b in self.page.locator("#betti b").all_inner_texts()]

    def cells(self):
        return int(self.text("#cells").split()[0].replace(",", ""))


@pytest.fixture(scope="module", params=["plane", "space"])
def subject(request):
    dim = len(SHAPES[request.param])
    fractions = noise(np.random.default_rng(dim), SHAPES[request.param])
    return make_subject(fractions, POLICIES[request.param], name=request.param)


@pytest.fixture(scope="module")
def opened(browser, subject, tmp_path_factory):
    path = tmp_path_factory.mktemp("explorer") / f"{subject.name} with spaces.html"
    path.write_text(make_page(subject), encoding="utf-8")
    opened = Opened(browser, path)
    yield opened
    assert opened.messages == []
    assert opened.requests == [path.as_uri()]  # Only the file itself is loaded.
    opened.page.close()


@pytest.fixture(autouse=True)
def from_the_start(request):
    """Begin every test at the chosen threshold, regardless of the test before."""
    if "opened" in request.fixturenames:
        page = request.getfixturevalue("opened")
        page.evaluate(
            "explorer.setView('cells'); explorer.step('chosen'); explorer.diagram.pin(-1)"
        )
        page.page.click("#tab-diagram")


def boundary_codes(kept, ranges=None):
    """Return faces between shown and other cells as (cell, direction), by comparing neighbours."""
    if kept.ndim == 2:
        return {(int(c), 5) for c in np.flatnonzero(kept)}
    shown = kept.copy()
    if ranges is not None:
        axis, start, stop = ranges
        layers = np.arange(kept.shape[axis])
        outside = (layers < start) | (layers >= stop)
        shown[(slice(None),) * axis + (outside,)] = False
    codes = set()
    flat = np.arange(kept.size).reshape(kept.shape)
    for axis in range(3):
        for side, step in enumerate((-1, 1)):
            beyond = np.roll(np.pad(shown, 1), -step, axis=axis)[(slice(1, -1),) * 3]
            codes |= {(int(c), 2 * axis + side) for c in flat[shown & ~beyond]}
    return codes


def drawn_codes(opened):
    """Return (cell, direction, state) of all faces; a solid shows three directions at a time."""
    codes = opened.evaluate(
        """() => {
        const { faces, plateaus, plateau, exceptions, window } = explorer;
        const out = [];
        for (const facing of faces.isFlat ? [[5]] : [[0, 2, 4], [1, 3, 5]]) {
          const n = faces.collect(plateaus.cut[plateau], exceptions, window, facing);
          for (let f = 0; f < n; f++) out.push(faces.code[4 * f]);
        }
        return out; }"""
    )
    found = [(c >> 5, c & 7, c >> 3 & 3) for c in codes]
    assert len(set(found)) == len(found)
    return found


def test_the_view_shows_the_boundary_of_the_kept_cells_at_random_thresholds(opened, subject):
    sets = CellSets(subject.fractions, Policy.from_dict(subject.selection.policy))
    rng = np.random.default_rng(5)
    for threshold in rng.uniform(0.001, 1.0, 25):
        opened.evaluate("t => explorer.setThreshold(t)", threshold)
        found = drawn_codes(opened)
        kept = sets.at(threshold).kept
        removed = (subject.fractions.cells >= threshold) & ~kept
        assert {f[:2] for f in found if f[2] != 1} == boundary_codes(kept)
        assert {f[0] for f in found if f[2] == 1} == set(np.flatnonzero(removed).tolist())


@pytest.mark.parametrize(("axis", "at"), [(0, 2), (1, 4), (2, 5)])
def test_a_cut_shows_the_boundary_of_the_layers_that_are_left(opened, subject, axis, at):
    page = opened.page
    if subject.fractions.grid.dim == 2:
        assert not page.is_visible("#cut-axis")
        return
    page.select_option("#cut-axis", str(axis))
    page.fill("#cut-at", str(at))
    sets = CellSets(subject.fractions, Policy.from_dict(subject.selection.policy))
    n = subject.fractions.grid.shape[axis]
    ranges = (axis, n - at, n) if axis == 1 else (axis, 0, at)
    for threshold in (0.9, 0.5, 0.1):
        opened.evaluate("t => explorer.setThreshold(t)", threshold)
        found = {f[:2] for f in drawn_codes(opened) if f[2] != 1}
        assert found == boundary_codes(sets.at(threshold).kept, ranges)
    page.select_option("#cut-axis", "")


def test_cells_and_betti_numbers_are_those_of_the_tables(opened, subject):
    dim = subject.fractions.grid.dim
    for row in subject.topologies.itertuples():
        opened.evaluate("t => explorer.setThreshold(t)", row.threshold)
        assert opened.cells() == row.cells
        assert opened.betti() == [row.betti_0, row.betti_1, row.betti_2][:dim]
        now = opened.evaluate("explorer.state()")
        assert now["raw"] == [row.raw_betti_0, row.raw_betti_1, row.raw_betti_2]
        assert now["lower"] <= row.threshold <= now["upper"]
        assert now["lower"] < now["threshold"] <= now["upper"]
        alive = count_alive(subject.diagram, np.array([now["threshold"]]))[0]
        for k in range(dim):
            assert (
                opened.evaluate(
                    "k => explorer.diagram.countAlive(k, explorer.state().threshold)", k
                )
                == alive[k]
            )


def test_the_slider_snaps_to_plateaus(opened, subject):
    for wanted in (0.03, 0.31, 0.77, 1.0):
        opened.page.fill("#slider", str(wanted))
        now = opened.evaluate("explorer.state()")
        assert now["lower"] < wanted <= now["upper"]
        value = float(opened.page.input_value("#slider"))
        assert value == now["threshold"]
        assert f"--threshold {value:g} " in opened.text("#command") + " "


def test_every_plateau_can_be_reached_with_the_keyboard(opened, subject):
    page = opened.page
    page.focus("#slider")
    page.keyboard.press("End")
    seen = [opened.evaluate("explorer.plateau")]
    n = opened.evaluate("explorer.plateaus.count")
    for _ in range(n - 1):
        page.keyboard.press("ArrowLeft")
        seen.append(opened.evaluate("explorer.plateau"))
    assert seen == list(range(n))
    page.keyboard.press("ArrowLeft")
    assert opened.evaluate("explorer.plateau") == n - 1
    page.keyboard.press("ArrowRight")
    assert opened.evaluate("explorer.plateau") == n - 2
    page.keyboard.press("End")
    # Page Down goes from one topology to the next and skips none.
    betti = subject.topologies.loc[
        subject.topologies["cells"] > 0, ["betti_0", "betti_1", "betti_2"]
    ]
    runs = 1 + int((betti.diff().iloc[1:] != 0).any(axis=1).sum())
    visited = set()
    for _ in range(2 * runs + 2):
        visited.add(
            opened.evaluate(
                "explorer.plateaus.runs.findIndex(run =>"
                " run.start <= explorer.plateau && explorer.plateau <= run.end)"
            )
        )
        page.keyboard.press("PageDown")
    assert visited - {-1} == set(range(runs))
    assert "kept" in page.get_attribute("#slider", "aria-valuetext")


def test_pointing_at_a_class_lights_up_its_cells(opened, subject):
    pairs = subject.diagram.sort_values(
        ["persistence", "dimension", "birth"], ascending=[False, True, False], kind="stable"
    )
    dying = int(np.flatnonzero(~pairs["essential"].to_numpy())[0])
    row = pairs.iloc[dying]
    assert opened.evaluate("explorer.markers.places.length") == 0
    box = opened.page.locator("#diagram").bounding_box()
    x, y = opened.evaluate("i => explorer.diagram.place(i)", dying)
    opened.page.mouse.move(box["x"] + x, box["y"] + y)
    shown = opened.evaluate("explorer.diagram.shown")
    # Another pair with the same birth and death may lie on the same point.
    found = pairs.iloc[shown]
    assert (found["birth"], found["death"]) == (row["birth"], row["death"])
    places = opened.evaluate("explorer.markers.places.map(p => p.centre)")
    grid = subject.fractions.grid
    expected = [[found[f"{event}_{a}"] for a in "xyz"[: grid.dim]] for event in ("death", "birth")]
    np.testing.assert_allclose(grid.to_points(np.array(places)[:, : grid.dim]), expected)
    assert opened.evaluate("explorer.markers.object.children.length") == 4  # Two boxes with edges.
    for event in ("birth", "death"):
        index = ", ".join(str(found[f"{event}_{a}"]) for a in "ijk"[: grid.dim])
        assert f"{found[f'{event}_at']} ({index}) enters" in opened.text("#pair")
    opened.page.mouse.move(5, 5)
    assert opened.evaluate("explorer.markers.places.length") == 0


def test_classes_can_be_walked_through_with_the_keyboard(opened, subject):
    page = opened.page
    page.focus("#diagram")
    seen = []
    for key in ("ArrowRight", "ArrowRight", "End", "ArrowRight", "ArrowLeft"):
        page.keyboard.press(key)
        seen.append(opened.evaluate("explorer.diagram.shown"))
    last = len(subject.diagram) - 1
    assert seen == [0, 1, last, 0, last]
    page.get_by_role("button", name="Set threshold to birth").click()
    now = opened.evaluate("explorer.state()")
    assert now["upper"] == opened.evaluate("explorer.diagram.birth(explorer.diagram.shown)")
    page.focus("#diagram")
    page.keyboard.press("Escape")
    assert opened.evaluate("explorer.diagram.shown") == -1


def test_the_final_mesh_has_all_its_facets(opened, subject):
    opened.page.click("[data-view=mesh]")
    mesh = subject.mesh
    shown = opened.evaluate("explorer.layers.mesh.object.geometry.drawRange.count / 6")
    if mesh.dim == 2:
        assert shown == mesh.n_cells
    else:
        faces = np.sort(
            mesh.cells[
                :,
                [
                    [0, 4, 7, 3],
                    [1, 2, 6, 5],
                    [0, 1, 5, 4],
                    [3, 7, 6, 2],
                    [0, 3, 2, 1],
                    [4, 5, 6, 7],
                ],
            ].reshape(-1, 4),
            axis=1,
        )
        assert shown == (np.unique(faces, axis=0, return_counts=True)[1] == 1).sum()
    assert opened.evaluate("explorer.layers.cells.object.visible") is False
    assert opened.evaluate("explorer.plateau === explorer.plateaus.chosen")
    legend = opened.text("#legend")
    for kind, count in zip(*np.unique(mesh.kind, return_counts=True), strict=True):
        name = KINDS[kind]
        assert f"{name} ({count:,})" in legend
    opened.page.focus("#slider")
    opened.page.keyboard.press("ArrowLeft")  # A move returns to the cells.
    assert opened.evaluate("explorer.view") == "cells"


def test_something_is_drawn(opened):
    """Count pixels of the kept cells' colour: WebGL does draw."""
    share = opened.evaluate(
        """() => { explorer.stage.draw();
        const gl = explorer.stage.renderer.getContext();
        const [w, h] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
        const pixels = new Uint8Array(4 * w * h);
        gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
        let n = 0;
        for (let i = 0; i < pixels.length; i += 4) n += pixels[i + 2] - pixels[i] > 25;
        return n / (w * h); }"""
    )
    assert share > 0.02


def test_only_faces_in_sight_are_drawn_and_all_of_them(opened, subject):
    """From all sides, exactly the faces whose direction faces the viewer are drawn."""
    if subject.fractions.grid.dim == 2:
        assert opened.evaluate("explorer.stage.facing") == [5]
        return
    kept = CellSets(subject.fractions, Policy.from_dict(subject.selection.policy)).at(0.5).kept
    expected = boundary_codes(kept)
    opened.evaluate("explorer.setThreshold(0.5)")
    for _ in range(6):
        opened.evaluate("explorer.stage.orbit(8, 0); explorer.stage.draw()")
        eye = opened.evaluate(
            "explorer.stage.camera.getWorldDirection(new THREE.Vector3()).toArray()"
        )
        facing = {2 * axis + (towards < 0) for axis, towards in enumerate(eye)}
        codes = opened.evaluate(
            "Array.from(explorer.faces.code.slice(0, 4 * explorer.faces.count))"
        )
        assert codes[::4] == codes[3::4]
        found = {(c >> 5, c & 7) for c in codes[::4] if c >> 3 & 3 != 1}
        assert found == {code for code in expected if code[1] in facing}


def test_the_stage_obeys_the_keyboard(opened, subject):
    page = opened.page
    page.focus("#stage")
    where = "[...explorer.stage.camera.position.toArray(), explorer.stage.camera.zoom]"
    before = opened.evaluate(where)
    page.keyboard.press("ArrowLeft")
    turned = opened.evaluate(where)
    assert turned != before
    page.keyboard.press("+")
    assert opened.evaluate(where)[3] > before[3]
    page.keyboard.press("0")
    np.testing.assert_allclose(opened.evaluate(where), before, atol=1e-6)


def test_tabs_follow_arrow_keys_and_focus_is_seen(opened):
    page = opened.page
    page.focus("#tab-diagram")
    for name in ("topologies", "defects", "quality", "diagram"):
        page.keyboard.press("ArrowRight")
        assert page.get_attribute(f"#tab-{name}", "aria-selected") == "true"
        assert page.is_visible(f"#panel-{name}")
        assert page.locator("[role=tabpanel]:visible").count() == 1
        outline = "getComputedStyle(document.activeElement).outlineStyle"
        assert opened.evaluate(outline) == "solid"
    for selector in ("button:visible", "input:visible", "select:visible", "[role=application]"):
        for control in page.locator(selector).all():
            named = control.evaluate("e => e.innerText || e.ariaLabel || e.labels?.length")
            assert named, control.evaluate("e => e.outerHTML")


def test_tables_are_shown_as_they_are(opened, subject):
    page = opened.page
    page.click("#tab-topologies")
    rows = page.locator("#panel-topologies tbody tr")
    rows.last.click()
    assert opened.evaluate("explorer.plateau") == opened.evaluate(
        "explorer.plateaus.runs.at(-1).middle"
    )
    assert "current" in rows.last.get_attribute("class")
    page.click("#tab-quality")
    assert "a check" in opened.text("#panel-quality")
    n = len(subject.tables["features"])
    assert page.locator("#panel-quality table").nth(2).locator("tbody tr").count() == n


def test_the_badge_of_a_model_with_warnings_is_not_that_of_a_suitable_one(browser, tmp_path):
    subject = make_subject(noise(np.random.default_rng(7), (4, 4)))
    colours = set()
    for verdict in ("yes", "warning", "no"):
        table = subject.tables["verdict"].assign(holds=verdict)
        path = tmp_path / f"{verdict}.html"
        page = make_page(replace(subject, tables=subject.tables | {"verdict": table}))
        path.write_text(page, encoding="utf-8")
        colours.add(Opened(browser, path).evaluate("getComputedStyle(verdict).color"))
    assert len(colours) == 3


def test_names_that_attack_are_only_text(browser, tmp_path):
    fractions = noise(np.random.default_rng(7), (4, 4))
    subject = make_subject(fractions)
    evil = subject.tables["verdict"].assign(name=ATTACK)
    tables = subject.tables | {
        "verdict": evil,
        "defects": subject.tables["defects"].assign(explanation=ATTACK),
    }
    selection = replace(subject.selection, reason=ATTACK, wanted=ATTACK)
    subject = replace(subject, name=ATTACK, unit=ATTACK, tables=tables, selection=selection)
    path = tmp_path / "attack.html"
    path.write_text(make_page(subject), encoding="utf-8")
    opened = Opened(browser, path)
    assert opened.page.title() == f"{ATTACK} - tusqh explorer"
    assert opened.text("#model-name") == ATTACK
    opened.page.click("[data-view=mesh]")
    assert ATTACK in opened.text("#note")
    opened.page.click("#tab-quality")
    assert ATTACK in opened.text("#panel-quality")
    assert opened.page.locator("img").count() == 0
    # The scripts are the facts, five blocks, three.js and the page's code.
    assert opened.page.locator("script").count() == 10
    assert opened.requests == [path.as_uri()]
    # If markup gets in nevertheless, the policy of the page does not let it run.
    opened.evaluate(
        "document.body.insertAdjacentHTML('beforeend', '<img src=x onerror=\"window.taken = 1\">')"
    )
    opened.page.wait_for_timeout(100)
    assert opened.evaluate("window.taken") is None
    assert any("Content Security Policy" in message for message in opened.messages)


def test_a_browser_without_webgl_still_shows_the_rest(browser, tmp_path):
    subject = make_subject(noise(np.random.default_rng(8), (4, 3, 4)))
    path = tmp_path / "plain.html"
    path.write_text(make_page(subject), encoding="utf-8")
    page = browser.new_page()
    page.add_init_script(
        """const old = HTMLCanvasElement.prototype.getContext;
        HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
          return kind === '2d' ? old.call(this, kind, ...more) : null;
        };"""
    )
    page.goto(path.as_uri())
    page.wait_for_selector("body[data-ready]")
    assert "WebGL 2" in page.inner_text("#failure")
    page.focus("#slider")
    page.keyboard.press("End")
    page.focus("#diagram")
    page.keyboard.press("ArrowRight")
    assert "enters" in page.inner_text("#pair")
    page.click("[data-view=mesh]")
    assert page.inner_text("#betti")


def test_numbers_survive_the_way_into_the_page(opened, subject):
    facts = json.loads(opened.evaluate("document.getElementById('facts-json').textContent"))
    assert facts["chosen"]["threshold"] == subject.selection.threshold
    assert facts["grid"] == subject.fractions.grid.to_dict()
    levels = opened.evaluate("Array.from(explorer.faces.tone)")
    keys = np.unique(np.clip(keys_of(subject.fractions.cells), 0, None).clip(max=2**20))
    assert len(levels) == len(np.union1d(keys, [0]))


def test_an_image_has_cells_and_a_mesh_but_no_geometry_to_show(browser, tmp_path):
    subject = make_subject(noise(np.random.default_rng(9), (4, 3, 4)))
    subject = replace(subject, geometry=Image(np.ones((2, 2, 2))))
    path = tmp_path / "image.html"
    path.write_text(make_page(subject), encoding="utf-8")
    opened = Opened(browser, path)
    assert not opened.page.is_visible("[data-view=geometry]")
    opened.page.focus("[data-view=cells]")
    opened.page.keyboard.press("ArrowLeft")  # The selection wraps around to the other view.
    assert opened.evaluate("explorer.view") == "mesh"
    assert opened.messages == []


@pytest.mark.parametrize("width", [1000, 600, 390])
def test_narrow_windows_show_the_picture_and_nothing_beside_them(opened, width):
    page = opened.page
    usual = page.viewport_size
    name = opened.text("#model-name")
    opened.evaluate("document.getElementById('model-name').textContent = 'long name '.repeat(5)")
    page.set_viewport_size({"width": width, "height": 800})
    height = opened.evaluate("document.getElementById('gl').clientHeight")
    wide = opened.evaluate("document.documentElement.scrollWidth")
    page.set_viewport_size(usual)
    opened.evaluate("n => { document.getElementById('model-name').textContent = n; }", name)
    assert height > 100
    assert wide <= width


@pytest.fixture(scope="module")
def sparse(browser, tmp_path_factory):
    """Return a page on two hills; runs of one, two and one component were examined at the ends."""
    heights = np.interp(np.arange(61), [0, 18, 38, 48, 60], [0.01, 1.0, 0.3, 0.7, 0.01])
    grid = BackgroundGrid(shape=(30, 2), cell_size=0.5, origin=(0.0, 0.0))
    fractions = VolumeFractions.from_values(grid, 4, np.repeat(heights[:, None], 5, axis=1))
    subject = make_subject(fractions, threshold=0.1)
    every = subject.topologies
    run = (every["betti_0"].diff() != 0).cumsum()
    is_end = (run != run.shift()) | (run != run.shift(-1))
    is_chosen = (every["lower"] < 0.1) & (every["upper"] >= 0.1)
    path = tmp_path_factory.mktemp("explorer") / "sparse.html"
    page = make_page(replace(subject, topologies=every[is_end | is_chosen]))
    path.write_text(page, encoding="utf-8")
    opened = Opened(browser, path)
    yield opened
    assert opened.messages == []
    opened.page.close()


def test_the_middle_of_a_run_is_a_plateau_that_was_examined(sparse):
    runs = sparse.evaluate("explorer.plateaus.runs")
    assert [run["betti"] for run in runs] == [[1, 0, 0], [2, 0, 0], [1, 0, 0]]
    for run in runs:
        assert run["start"] + 1 < run["end"]
        assert run["start"] <= run["middle"] <= run["end"]
        assert sparse.evaluate("p => explorer.plateaus.mesh(p)", run["middle"]) == run["betti"]
    sparse.evaluate("explorer.step('most')")
    sparse.page.focus("#slider")
    for run in (*runs, runs[-1]):  # Start above the first topology; there is none below the last.
        sparse.page.keyboard.press("PageDown")
        assert sparse.evaluate("explorer.plateau") == run["middle"]
        assert sparse.evaluate("explorer.state().mesh") == run["betti"]


def test_numbers_of_the_filtration_are_called_so_once(sparse):
    sparse.evaluate("explorer.setPlateau(explorer.plateaus.runs[0].start + 1)")
    assert sparse.evaluate("explorer.state().mesh") is None
    assert sparse.text("#betti").count("not predicted") == 1
    for element in ("#betti", "#betti p"):
        fits = "(e) => e.scrollWidth <= e.clientWidth"
        assert sparse.page.locator(element).evaluate(fits)
    spoken = sparse.page.get_attribute("#slider", "aria-valuetext")
    assert "(of the filtration; mesh not predicted here)" in spoken
    sparse.evaluate("explorer.step('chosen')")
    assert "filtration;" not in sparse.text("#betti")
    assert "filtration" not in sparse.page.get_attribute("#slider", "aria-valuetext")


def test_the_ends_of_a_plateau_differ(opened):
    for ends, shown in (
        ([0.4375, 0.4375 + 2**-20], ["0.4375", "0.437501"]),
        ([1 - 2**-20, 1], ["0.999999", "1"]),
        ([0.25, 0.5], ["0.25", "0.5"]),
        ([0, 2**-20], ["0", "9.54e-7"]),
    ):
        assert opened.evaluate("([low, high]) => showApart(low, high)", ends) == shown


@pytest.fixture(scope="module", params=["plane", "space"])
def local(request, browser, tmp_path_factory):
    """Return a model of local changes, and its page."""
    shape = SHAPES[request.param]
    fractions = noise(np.random.default_rng(3), shape)
    table = Plateaus(CellSets(fractions)).table
    at_base = CellSets(fractions).at(0.5).predicted
    wanted = next(b for b in table[BETTI].to_numpy()[len(table) // 4 :].tolist() if b != [*at_base])
    goal = {"target": dict(zip(BETTI, wanted, strict=True))}
    subject = make_subject(fractions, goal, name=f"local_{request.param}")
    path = tmp_path_factory.mktemp("explorer") / "local.html"
    path.write_text(make_page(subject), encoding="utf-8")
    opened = Opened(browser, path)
    yield subject, opened
    assert opened.messages == []
    opened.page.close()


def n_sides(group, shape):
    """Return at how many sides cells meet others; in the plane their number."""
    if len(shape) == 2:
        return len(group)
    is_there = np.zeros(np.prod(shape), dtype=int)
    is_there[group] = 1
    padded = np.pad(is_there.reshape(shape), 1)
    return sum(int(np.abs(np.diff(padded, axis=axis)).sum()) for axis in range(3))


def test_the_final_mesh_of_local_changes_is_that_of_the_library(local):
    subject, opened = local
    cells = subject.selection.cells
    opened.page.click("[data-view='mesh']")
    assert opened.betti() == list(cells.predicted)[: cells.kept.ndim]
    assert opened.cells() == cells.kept.sum()
    assert opened.evaluate("explorer.state().threshold") == 0.5
    shown = opened.evaluate("explorer.changes.map(({cells}) => [...cells])")
    added, left_out = cells.kept & ~cells.in_base, cells.in_base & ~cells.kept
    assert shown == [np.flatnonzero(added).tolist(), np.flatnonzero(left_out).tolist()]
    drawn = "explorer.boxes.object.children.map((box) => box.geometry.attributes.position.count)"
    counts = [4 * n_sides(group, cells.kept.shape) for group in shown if group]
    assert opened.evaluate(drawn) == counts != []
    settings = from_options(Settings, options_in(opened.text("#command")))
    assert settings.goal.target == subject_goal(subject)
    assert f"{cells.n_changes} cell" in opened.text("#note")
    opened.page.click("[data-view='cells']")
    assert opened.evaluate(drawn) == []
    assert "--threshold 0.5" in opened.text("#command")


def test_a_click_on_a_class_offers_what_can_be_done_and_shows_the_cells(local):
    subject, opened = local
    features = Features(CellSets(subject.fractions), 0.5)
    prices = tabulate_prices(features)
    offers = opened.evaluate("explorer.wishes.offers")
    assert len(offers) == len(prices)
    n_shown = 0
    for k in range(0, len(offers), max(1, len(offers) // 8)):
        price = prices.iloc[k]
        assert (offers[k]["row"], offers[k]["do"]) == (price["row"], price["do"])
        pair = offers[k]["pair"]
        assert opened.evaluate("p => explorer.diagram.birth(p)", pair) == price["birth"]
        opened.evaluate("p => { explorer.diagram.pinned = -1; explorer.diagram.pin(p); }", pair)
        if not price["possible"]:
            assert price["why"] in opened.text("#pair")
            continue
        before = opened.evaluate("explorer.facts.final.base")
        opened.page.click(f'#pair [data-wish="{k}"]')
        assert opened.evaluate("explorer.state().threshold") == before
        settings = from_options(Settings, options_in(opened.text("#command")))
        (wish,) = settings.goal.features
        assert (wish.row, wish.do, settings.goal.threshold) == (price["row"], price["do"], 0.5)
        chosen, _ = choose_threshold(Plateaus(CellSets(subject.fractions)), settings.goal)
        assert opened.cells() == chosen.cells.kept.sum()
        assert opened.betti() == list(chosen.predicted)[: chosen.cells.kept.ndim]
        shown = opened.evaluate("[...explorer.wishes.cells(explorer.wishes.shown)]")
        assert shown == np.flatnonzero(chosen.cells.kept != chosen.cells.in_base).tolist()
        opened.page.click(f'#pair [data-wish="{k}"]')
        assert "--threshold 0.5" in opened.text("#command")
        assert opened.evaluate("explorer.boxes.object.children.length") == 0
        n_shown += 1
    assert n_shown > 3


def subject_goal(subject):
    """Return the target of the command that makes the final mesh."""
    return from_options(Settings, options_in(subject.command.goal)).goal.target


def options_in(line):
    """Return the options of a command line, by name; those of features are lists."""
    words, options = shlex.split(line), {}
    for k, word in enumerate(words):
        name = word.removeprefix("--").replace("-", "_")
        if word.startswith("--") and name in ("open", "cut", "fill"):
            options.setdefault(name, []).append(words[k + 1])
        elif word.startswith("--"):
            options[name] = words[k + 1]
    return options


def test_a_fitted_boundary_is_coloured_by_its_distance(browser, subject, tmp_path):
    path = tmp_path / "fitted.html"
    path.write_text(make_page(replace(subject, is_fitted=True)), encoding="utf-8")
    opened = Opened(browser, path)
    opened.page.click("[data-view=mesh]")
    opened.page.select_option("#colour", "distance")
    drawn = """() => {
      const { object, count } = explorer.layers.mesh;
      return Array.from(object.geometry.attributes.quality.array.slice(0, 4 * count));
    }"""
    shown = opened.evaluate(drawn)
    colours = as_colours(
        boundary_distances(subject.mesh, subject.geometry, subject.fractions.grid)
    ).tolist()
    if subject.mesh.dim == 3:
        assert sorted(shown[::4]) == sorted(colours)
    else:
        assert set(shown) <= {*colours, NONE}
    assert "0.2 cells (0.1 mm) or more" in opened.text("#legend")
    opened.page.select_option("#colour", "quality")
    assert opened.evaluate(drawn) != shown
    assert opened.messages == []
    opened.page.close()
