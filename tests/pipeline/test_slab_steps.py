"""The steps of a mesh in slabs, which are jobs of the workflow, give the files of one run."""

from dataclasses import fields

import numpy as np
import pytest
from test_slab_meshes import random_fractions
from test_slab_runs import CELLS, ring

from tusqh.antialias.cells import CellSets
from tusqh.atomic import write_text
from tusqh.contacts.one_material import VOID
from tusqh.contacts.slab_elements import emit_slab, emit_window
from tusqh.errors import ConfigError
from tusqh.geometry.canonical import load_geometry
from tusqh.grid.slabs import LEAST, cut
from tusqh.hashing import canonical_json
from tusqh.pipeline.slabs.mesh import mesh_in_slabs
from tusqh.pipeline.slabs.recheck import check_in_pieces
from tusqh.pipeline.slabs.sample import original_of
from tusqh.pipeline.slabs.steps import (
    decide,
    emit_elements,
    lay,
    merge,
    read_layout,
    write_piece_of,
)
from tusqh.pipeline.slabs.windows import read_window, write_windows
from tusqh.settings.model import Settings


def run_steps(folder, geometry, settings, n_slabs):
    """Run every step in its order, each from the files of those before."""
    original = original_of(geometry, settings)
    (folder / "slabs").mkdir(parents=True)
    path, contacts = folder / "slabs/grid.json", folder / "slabs/contacts.npz"
    layout = lay(original, settings, n_slabs, folder, name="mesh")
    write_text(path, canonical_json(layout.to_dict()))
    assert read_layout(path) == layout
    for slab in reversed(layout.slabs):
        layout.fractions(folder, original).multiples(slab)
    decide(layout, original, folder, contacts, name="mesh")
    for k in range(n_slabs):
        emit_elements(layout, contacts, k, folder / f"slabs/elements/{k:04d}.npz")
    for k in range(n_slabs):
        write_piece_of(layout, folder, k, folder / f"mesh_pieces/{k:04d}.vtu")
    return merge(layout, original, settings, folder, reading={}, name="mesh")


@pytest.mark.parametrize(
    "options", [{}, {"rule": "clamped", "threshold": 0.3}, {"grid": {"placement": "corner"}}]
)
def test_steps_write_the_files_of_one_run(tmp_path, options):
    grid = {"cells": CELLS, **options.get("grid", {})}
    settings = Settings.from_dict({**options, "grid": grid, "slabs": 3})
    once, steps = tmp_path / "once", tmp_path / "steps"
    mesh_in_slabs(ring(), settings, [], results=once, name="mesh")
    report = run_steps(steps, load_geometry(once / "geometry.vtp"), settings, 3)
    assert report.facts["betti_measured"] == [1, 1, 0]
    names = {path.relative_to(once) for path in once.rglob("*.*")}
    names -= {path for path in names if path.name in ("geometry.vtp", "reading.json")}
    assert len(names) == 11
    for name in names:
        assert (steps / name).read_bytes() == (once / name).read_bytes(), name
    table, _ = check_in_pieces(steps / "mesh.pvtu")
    assert set(table["holds"]) == {"yes", "not run"}


@pytest.mark.parametrize("seed", range(4))
def test_elements_follow_from_the_part_of_the_decision_on_disk(tmp_path, seed):
    fractions = random_fractions(seed)
    grid, decision = fractions.grid, CellSets(fractions).at(0.5).decision
    slabs = cut(grid, grid.shape[0] // LEAST)
    write_windows(tmp_path / "contacts.npz", decision, grid, slabs)
    for slab in slabs:
        window = read_window(tmp_path / "contacts.npz", grid, slab)
        found = emit_window(window, grid, slab, left_out=VOID)
        expected = emit_slab(decision, grid, slab, left_out=VOID)
        for field in fields(expected):
            assert np.array_equal(getattr(found, field.name), getattr(expected, field.name))


def test_jobs_without_work_are_refused(tmp_path):
    settings = Settings.from_dict({"grid": {"cells": CELLS}, "slabs": 2})
    mesh_in_slabs(ring(), settings, [], results=tmp_path / "once", name="mesh")
    geometry = load_geometry(tmp_path / "once/geometry.vtp")
    with pytest.raises(ConfigError, match=r"9 slabs of a grid with 20 cells .*(?s:.*)`slabs: 5`"):
        run_steps(tmp_path / "many", geometry, settings, 9)
    window = {"lower": [-1.5, -1.5, -0.5], "upper": [9.0, 1.5, 0.5]}
    apart = Settings.from_dict({"grid": {"cell_size": 0.2}, "window": window, "slabs": 3})
    with pytest.raises(ConfigError, match="slab 1 of 3 has no kept cells"):
        run_steps(tmp_path / "apart", geometry, apart, 3)
