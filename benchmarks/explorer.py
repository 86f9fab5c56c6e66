"""Slider steps of an explorer in software rendering: ``python -m benchmarks.explorer``.

Each case is opened from disk in headless Chromium.  A step is a jump to a distant plateau; `script`
is the time that its code takes, and `all` also includes drawing by the processor, until the pixels
can be read back.  A click shows the cells that a wish for a class would change.  White noise has a
face between nearly all cells and is the worst case.
"""

from __future__ import annotations

import shutil
import statistics
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
from playwright.sync_api import Browser, sync_playwright
from scipy import ndimage

import tusqh
from tusqh.explorer.page import make_page
from tusqh.explorer.subject import Subject, subject_of
from tusqh.geometry.packaged import locate
from tusqh.grid import BackgroundGrid
from tusqh.sampling.fractions import VolumeFractions, round_fractions
from tusqh.tables import write_csv
from tusqh.topology.persistence import locate_pairs
from tusqh.topology.topology import Topology

RESULT = Path("results/benchmarks/explorer.csv")
STEPS = 40
FLAGS = [
    *("--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader"),
    *("--enable-unsafe-swiftshader", "--disable-background-networking", "--no-first-run"),
]
MODELS = [
    ("bunny", "package:pymeshlab/tests/sample_meshes/bunny.obj", 60),
    ("bearings", "data_sources/solids/bearings.stl", 60),
    ("dragon", "data_sources/dragon/dragon.off", 60),
]

#: Shows what each possible wish would change, one after the other, as a click on its button does.
_CLICK = """async (most) => {
  const { stage, wishes } = explorer;
  const gl = stage.renderer.getContext();
  const pixel = new Uint8Array(4);
  const times = [];
  for (let k = 0; k < wishes.offers.length && times.length < most; k++) {
    if (wishes.offers[k].why) continue;
    const start = performance.now();
    explorer.showWish(k);
    const script = performance.now() - start;
    cancelAnimationFrame(stage.pending);
    stage.pending = 0;
    stage.draw();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    times.push([script, performance.now() - start]);
    await new Promise((done) => setTimeout(done, 30));
  }
  return times;
}"""

_STEP = """async (steps) => {
  const { stage, plateaus } = explorer;
  const gl = stage.renderer.getContext();
  const pixel = new Uint8Array(4);
  const times = [];
  for (let s = 0; s < steps; s++) {
    const p = Math.round((s * 0.382 % 1) * (plateaus.count - 1));
    if (p === explorer.plateau) continue;
    const start = performance.now();
    explorer.setPlateau(p);
    const script = performance.now() - start;
    cancelAnimationFrame(stage.pending);
    stage.pending = 0;
    stage.draw();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    times.push([script, performance.now() - start]);
    await new Promise((done) => setTimeout(done, 30));
  }
  return times;
}"""


def main() -> None:
    """Measure, print and write the table."""
    browser_path = next(filter(None, map(shutil.which, ("chromium", "google-chrome"))))
    rows = []
    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as folder:
        browser = playwright.chromium.launch(executable_path=browser_path, args=FLAGS)
        for name, geometry, cells in MODELS:
            result = tusqh.mesh(locate(geometry), cells=cells, name=name)
            subject = subject_of(result, geometry=geometry)
            rows.append(_measure(browser, subject, Path(folder)))
        for kind, sigma in (("smooth noise", 2.0), ("white noise", 0.0)):
            noise = _with_noise(subject, kind, sigma)
            rows.append(_measure(browser, noise, Path(folder)))
        browser.close()
    write_csv(RESULT, pd.DataFrame(rows))


def _with_noise(subject: Subject, name: str, sigma: float, n: int = 60) -> Subject:
    """Return a subject whose field is noise of 64 levels; its mesh does not change."""
    field = ndimage.gaussian_filter(np.random.default_rng(0).random((2 * n + 1,) * 3), sigma)
    ranks = field.ravel().argsort().argsort().reshape(field.shape)
    grid = BackgroundGrid(shape=(n,) * 3, cell_size=1.0, origin=(0.0, 0.0, 0.0))
    values = round_fractions(np.floor(64 * ranks / ranks.size + 0.5) / 64)
    topology = Topology.from_fractions(values)
    curves = topology.curves
    topologies = curves.assign(
        threshold=(curves["upper"] + curves["lower"]) / 2,
        contacts=0,
        bridges=0,
        removed=0,
        filled=0,
    )
    return replace(
        subject,
        name=name,
        fractions=VolumeFractions.from_values(grid, 4, values),
        curves=curves,
        topologies=topologies,
        diagram=locate_pairs(topology.pairs, grid),
    )


def _measure(browser: Browser, subject: Subject, folder: Path) -> dict[str, object]:
    path = folder / f"{subject.name}.html"
    path.write_text(make_page(subject), encoding="utf-8")
    page = browser.new_page(viewport={"width": 1280, "height": 800})
    page.goto(path.as_uri())
    page.wait_for_selector("body[data-ready]")
    page.wait_for_timeout(500)
    page.evaluate(_STEP, 5)  # Compile before measuring.
    script, everything = zip(*page.evaluate(_STEP, STEPS), strict=True)
    row = {
        "case": subject.name,
        "grid": subject.fractions.grid.label,
        "faces": page.evaluate("explorer.faces.cell.length"),
        "pairs": page.evaluate("explorer.diagram.count"),
        "plateaus": page.evaluate("explorer.plateaus.count"),
        "megabytes": round(path.stat().st_size / 1e6, 2),
        "script_median_ms": round(statistics.median(script), 2),
        "script_max_ms": round(max(script), 2),
        "all_median_ms": round(statistics.median(everything), 1),
        "all_max_ms": round(max(everything), 1),
    }
    clicks = page.evaluate(_CLICK, STEPS)
    if clicks:
        script, everything = zip(*clicks, strict=True)
        row |= {
            "clicks": len(clicks),
            "click_script_max_ms": round(max(script), 2),
            "click_all_median_ms": round(statistics.median(everything), 1),
            "click_all_max_ms": round(max(everything), 1),
        }
    page.close()
    print("  ".join(f"{key} {value}" for key, value in row.items()), flush=True)
    return row


if __name__ == "__main__":
    main()
