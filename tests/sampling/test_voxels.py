"""Fractions from voxels by three methods: half voxels, an integral, and the winding number."""

import hypothesis.extra.numpy as arrays
import hypothesis.strategies as st
import numpy as np
import pytest
import trimesh
from hypothesis import given, settings

from tusqh.errors import SamplingError
from tusqh.geometry.image import Image
from tusqh.geometry.soup import Soup
from tusqh.sampling import voxels as module
from tusqh.sampling.fractions import RESOLUTION, sample_fractions
from tusqh.sampling.voxels import lay_on_voxels, voxel_fractions
from tusqh.settings.sampling import Sampling


def integrate(image, grid):
    """Return fractions by definition: integrate over each fictitious cell, one axis at a time."""
    values = image.fractions()
    for axis, (n, origin) in enumerate(zip(grid.shape, grid.origin, strict=True)):
        edges = np.arange(values.shape[axis] + 1.0)
        integral = np.concatenate(
            [np.zeros_like(values.take([0], axis=axis)), np.cumsum(values, axis=axis)], axis=axis
        )
        first = (origin - image.origin[axis]) / image.voxel_size
        per_cell = grid.cell_size / image.voxel_size
        middle = first + per_cell * np.arange(2 * n + 1) / 2
        ends = [np.clip(middle + step * per_cell / 2, 0, len(edges) - 1) for step in (-1, 1)]
        # Nothing beyond the grid counts, which may end before the image does.
        ends = [np.clip(end, first, first + n * per_cell) for end in ends]
        low, high = (
            np.apply_along_axis(lambda line, e=e, at=edges: np.interp(e, at, line), axis, integral)
            for e in ends
        )
        values = (high - low) / per_cell
    return values


@settings(max_examples=60, deadline=None)
@given(
    arrays.arrays(
        np.uint8,
        arrays.array_shapes(min_dims=3, max_dims=3, max_side=7),
        elements=st.integers(0, 9),
    ),
    st.integers(1, 7),
    st.sampled_from([1.0, 0.1, 3.0]),
)
def test_fractions_are_integrals(grey, cells, voxel_size):
    image = Image(grey, voxel_size, 0, 9, (0.5, -1.0, 7.0))
    grid = lay_on_voxels(image, cells=cells)
    assert max(grid.shape) <= cells
    if not grey.any():
        with pytest.raises(SamplingError, match="positive fraction"):
            voxel_fractions(image, grid)
        return
    fractions = voxel_fractions(image, grid)
    assert fractions.values == pytest.approx(integrate(image, grid), abs=RESOLUTION)
    n_full = grey.sum() / 9
    assert fractions.volume() == pytest.approx(
        n_full * voxel_size**3, abs=1e-5 * voxel_size**3 * 343
    )


@pytest.mark.parametrize("cells", [8, 4, 3, 2])
def test_a_surface_around_the_voxels_gives_the_same(cells):
    """Sample the winding number of all cubes at the centres of half voxels."""
    kept = np.random.default_rng(5).random((8, 8, 8)) < 0.4
    image = Image.from_voxels(kept, voxel_size=0.5)
    cubes = [
        trimesh.creation.box((0.5,) * 3).apply_translation(c) for c in np.argwhere(kept) / 2 + 0.25
    ]
    mesh = trimesh.util.concatenate(cubes)
    soup = Soup(mesh.vertices, np.asarray(mesh.faces), np.zeros(len(mesh.faces), dtype=int))
    grid = lay_on_voxels(image, cells=cells)
    by_voxels = voxel_fractions(image, grid)
    assert by_voxels.samples == 2 * round(grid.cell_size / 0.5)
    by_winding = sample_fractions(soup, grid, sampling=Sampling(samples=by_voxels.samples))
    assert np.array_equal(by_voxels.values, by_winding.values)


def test_layers_make_no_difference(monkeypatch):
    image = Image.from_voxels(np.random.default_rng(1).random((20, 9, 11)))
    grid = lay_on_voxels(image, cells=7)
    at_once = voxel_fractions(image, grid).values
    monkeypatch.setattr(module, "VOXELS_AT_A_TIME", 1)
    assert np.array_equal(voxel_fractions(image, grid).values, at_once)


def test_pores_and_windows():
    kept = np.zeros((6, 6, 6), dtype=bool)
    kept[:3] = True
    image = Image.from_voxels(kept, voxel_size=2.0)
    grid = lay_on_voxels(image, cells=6)
    material, pores = (voxel_fractions(image, grid, domain=d) for d in ("inside", "outside"))
    assert np.array_equal(pores.cells, 1 - material.cells)
    window = ((0.0, 0.0, 0.0), (12.0, 12.0, 5.5))  # The centre of the third voxel, at 5, is inside.
    grid = lay_on_voxels(image, window, cells=6)
    assert grid.shape == (6, 6, 3)
    pores = voxel_fractions(image, grid, domain="outside", window=window)
    assert pores.volume() == 3 * 6 * 3 * 8
    window = ((0.0, 0.0, 0.0), (12.0, 12.0, 4.5))
    pores = voxel_fractions(image, lay_on_voxels(image, window, cells=6), window=window)
    assert pores.volume() == 3 * 6 * 2 * 8


@pytest.mark.parametrize(
    ("size", "shape", "cell_size"),
    [
        ({"cells": 64}, (50, 30, 10), 1.0),
        ({"cells": 100}, (100, 60, 20), 0.5),
        ({"cells": 1000}, (100, 60, 20), 0.5),
        ({"cells": 33}, (25, 15, 5), 2.0),
        ({"cells": [100, 10, 20]}, (17, 10, 4), 3.0),
        ({"cell_size": 1.5}, (34, 20, 7), 1.5),
    ],
)
def test_cells_are_whole_voxels(size, shape, cell_size):
    image = Image(np.zeros((100, 60, 20), dtype=np.uint8), 0.5)
    grid = lay_on_voxels(image, **size)
    assert (grid.shape, grid.cell_size) == (shape, cell_size)


@pytest.mark.parametrize(
    ("window", "size", "message"),
    [
        (None, {"cell_size": 0.7}, "1.4 voxels"),
        (None, {"cell_size": 0.1}, "0.2 voxels"),
        (None, {"cells": [3, 3]}, "2 numbers"),
        (((0.0, 0.0), (1.0, 1.0)), {"cells": 4}, "2 numbers"),
        (((9.0, 9, 9), (10.0, 10, 10)), {"cells": 4}, "misses the image"),
    ],
)
def test_grids_that_do_not_fit_are_explained(window, size, message):
    image = Image(np.ones((4, 4, 4)), 0.5)
    with pytest.raises(SamplingError, match=message):
        lay_on_voxels(image, window, **size)
