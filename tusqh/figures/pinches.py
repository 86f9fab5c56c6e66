"""The eleven pinch configurations of eight cells, raw, separated and connected."""

from __future__ import annotations

import itertools

import numpy as np
from matplotlib.figure import Figure

from tusqh.antialias.clusters import decide_by_vote
from tusqh.antialias.pinches import find_pinches, pinch_table
from tusqh.antialias.resolve import resolve
from tusqh.figures import style
from tusqh.figures.rendering import render, show, surface_of
from tusqh.grid import HEX_CORNERS, BackgroundGrid, BoolArray
from tusqh.meshes.volume_mesh import VolumeMesh


def list_configurations() -> list[BoolArray]:
    """Return one neighbourhood of 2 x 2 x 2 cells for each kind of pinch, by rising cell count.

    Kinds that a rotation or reflection turns into each other are one.

    >>> len(list_configurations())
    11
    """
    smallest = set()
    for code in np.flatnonzero(pinch_table(3)):
        cells = _cells_of(int(code))
        smallest.add(
            min(
                _code_of(cells.transpose(axes)[flips])
                for axes in itertools.permutations(range(3))
                for flips in itertools.product((slice(None), slice(None, None, -1)), repeat=3)
            )
        )
    return sorted(map(_cells_of, smallest), key=lambda cells: (cells.sum(), _code_of(cells)))


def draw_pinches() -> Figure:
    """Return one column per configuration: the cells, then the real meshes of both decisions."""
    configurations = list_configurations()
    figure, axes = style.new_figure(3, len(configurations), width=17.0, height=5.6)
    grid = BackgroundGrid(shape=(2, 2, 2), cell_size=1.0, origin=(0.0, 0.0, 0.0))
    box = ((0.0, 0.0, 0.0), (2.0, 2.0, 2.0))
    for column, kept in enumerate(configurations):
        pinches = find_pinches(kept)
        meshes = [_raw(kept)]
        for connect in (False, True):
            decisions = decide_by_vote(pinches, np.full(pinches.shape, connect))
            meshes.append(resolve(kept, decisions, grid, name="pinch")[0])
        names = (f"case {column + 1}", "separated", "connected")
        for row, (mesh, title) in enumerate(zip(meshes, names, strict=True)):
            picture = render(
                surface_of(mesh),
                box,
                size=(360, 360),
                scalars="rgb",
                rgb=True,
                show_edges=True,
                edge_color="#203040",
                line_width=1.5,
            )
            show(axes[row, column], picture, title)
    figure.suptitle("The pinches of eight cells, and the templates that resolve them")
    return figure


def _cells_of(code: int) -> BoolArray:
    """Return the cells of a neighbourhood code, indexed [i, j, k]."""
    bits = np.array([code >> bit & 1 for bit in range(8)], dtype=bool)
    return bits.reshape(2, 2, 2).transpose(2, 1, 0)


def _code_of(cells: BoolArray) -> int:
    bits = cells.transpose(2, 1, 0).ravel()
    return int(sum(1 << bit for bit in range(8) if bits[bit]))


def _raw(kept: BoolArray) -> VolumeMesh:
    """Return the kept cells as they are, pinch and all."""
    places = np.argwhere(kept)[:, None] + HEX_CORNERS
    cells = np.ravel_multi_index(tuple(np.moveaxis(places, -1, 0)), (3, 3, 3))
    points = np.argwhere(np.ones((3, 3, 3), dtype=bool)).astype(float)
    return VolumeMesh.from_arrays(points, cells)
