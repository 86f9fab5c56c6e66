"""The estimate of memory is right within 30 %, and a grid that does not fit is refused."""

import tempfile
from pathlib import Path

import numpy as np
import pytest
import trimesh

import tusqh
from benchmarks.measure import measure
from tusqh.errors import SamplingError
from tusqh.pipeline.ingest import ingest
from tusqh.pipeline.sample import sample
from tusqh.sampling.memory import estimate_memory, estimate_slabs
from tusqh.settings.grid import Grid


def prepare(shape, cells):
    """Return a geometry and the cells along its longest side."""
    if shape == "disc":
        angles = np.linspace(0, 2 * np.pi, 100, endpoint=False)
        points = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        return (points, np.stack([np.arange(100), (np.arange(100) + 1) % 100], axis=1)), cells
    if shape == "box":
        return trimesh.creation.box([1, 1, 0.8]), cells
    return trimesh.creation.icosphere(subdivisions=3), cells


def mesh(prepared):
    """Mesh a geometry at the threshold 1/2."""
    source, cells = prepared
    return tusqh.mesh(source, cells=cells, threshold=0.5)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("shape", "cells", "share"),
    [
        ("ball", 96, np.pi / 6),
        ("ball", 144, np.pi / 6),
        ("box", 112, 1.0),
        ("disc", 900, np.pi / 4),
    ],
)
def test_the_estimate_is_right_within_thirty_percent(shape, cells, share):
    cost = measure(prepare, mesh, (shape, 12), shape, cells)
    dim = 2 if shape == "disc" else 3
    n_cells = round(cells**dim * (0.8 if shape == "box" else 1.0))
    estimate = estimate_memory(n_cells, round(share * n_cells), dim=dim)
    assert estimate / 1e9 == pytest.approx(cost.peak_gb, rel=0.3)


def prepare_slabs(shape, cells, n_slabs):
    """Return a geometry, its cells and slabs; nothing for the warm-up, which must not count."""
    return None if shape is None else (*prepare(shape, cells), n_slabs)


def mesh_slabs(prepared):
    """Mesh a geometry in slabs, with its pieces and checks."""
    if prepared is None:
        return
    source, cells, n_slabs = prepared
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mesh.pvtu"
        tusqh.mesh(source, cells=cells, placement="corner", slabs=n_slabs, output=path)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("shape", "cells", "n_slabs", "share"),
    [("box", 112, 4, 1.0), ("ball", 160, 4, np.pi / 6), ("ball", 160, 16, np.pi / 6)],
)
def test_the_estimate_in_slabs_is_right_within_thirty_percent(shape, cells, n_slabs, share):
    cost = measure(prepare_slabs, mesh_slabs, (None, 0, 0), shape, cells, n_slabs)
    n_cells = round(cells**3 * (0.8 if shape == "box" else 1.0))
    estimate = estimate_slabs(n_cells, round(share * n_cells), n_slabs)
    assert estimate / 1e9 == pytest.approx(cost.peak_gb, rel=0.3)


def test_a_grid_that_does_not_fit_is_refused_with_estimate_and_remedies(monkeypatch):
    ball = ingest(prepare("ball", 1)[0])
    sample(ball, grid=Grid(cells=20))
    for free, fits in ((47_000_000, True), (45_500_000, False)):
        monkeypatch.setattr("tusqh.sampling.memory.available_memory", lambda free=free: free)
        if fits:
            sample(ball, grid=Grid(cells=20))
            continue
        with pytest.raises(SamplingError, match="meshing on the 20x20x20 grid of 8,000") as caught:
            sample(ball, grid=Grid(cells=20))
        assert "0.0461 GB" in str(caught.value)
        assert "`window`" in str(caught.value)
