"""Draw the pictures of the documentation into docs/images: ``python docs/pictures.py``.

Everything in them is computed: `tusqh.mesh` makes the meshes, the library computes the numbers.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from PIL import Image

import tusqh
from tusqh.figures import style
from tusqh.figures.rendering import (
    EDGES,
    grid_of,
    polydata_of,
    render,
    show,
    surface_of,
    without_margins,
)
from tusqh.geometry.outline import Outline
from tusqh.meshes.volume_mesh import VolumeMesh

ROOT = Path(__file__).parent.parent
FOLDER = Path(__file__).parent / "images"


def broken_ring() -> Outline:
    """Return the outline of the pages on thresholds: a ring with a thin place, and a dot."""
    turn = np.linspace(0, 2 * np.pi, 90)
    ring = np.column_stack([np.cos(turn), np.sin(turn)])
    # The hole is off-centre, so that the ring is thin on its right.
    inside = 0.66 * ring[::-1] + [0.24, 0.05]
    dot = 0.2 * ring + [1.42, -0.75]
    return Outline.from_chains([ring, inside, dot], name="ring")


def draw_betti_numbers() -> Figure:
    """Draw three solids that show what the three Betti numbers count."""
    spheres = trimesh.creation.icosphere(subdivisions=3, radius=1.0)
    two = trimesh.util.concatenate([spheres, spheres.copy().apply_translation([2.6, 0, 0])])
    torus = trimesh.creation.torus(1.0, 0.4)
    shell = trimesh.creation.icosphere(subdivisions=4, radius=0.75)
    shell.invert()
    hollow = trimesh.util.concatenate([spheres, shell])
    figure, axes = style.new_figure(1, 3, width=9.0, height=3.1)
    for panel, solid, words in zip(
        axes[0],
        (two, torus, hollow),
        ("two components", "one hole to see through", "one void, cut open"),
        strict=True,
    ):
        result = tusqh.mesh(solid, cells=26)
        betti = result.report.measured
        surface = surface_of(_cut(result.mesh) if betti.betti_2 else result.mesh)
        box = solid.bounds
        picture = render(surface, (box[0], box[1]), scalars="rgb", rgb=True, **EDGES)
        numbers = ", ".join(rf"$\beta_{k}$ = {number}" for k, number in enumerate(betti))
        show(panel, picture, f"{words}: {numbers}")
    return figure


def draw_thresholds() -> Figure:
    """Draw the ring at four thresholds, with the Betti numbers of each mesh."""
    outline = broken_ring()
    thresholds = (0.9, 0.6, 0.3, 0.1)
    figure, axes = style.new_figure(1, 4, width=10.0, height=3.0)
    for panel, threshold in zip(axes[0], thresholds, strict=True):
        result = tusqh.mesh(outline, cells=16, threshold=threshold, bridges="none")
        _draw_quads(panel, result)
        style.draw_outline(panel, outline, 1.0)
        betti = result.report.measured
        panel.set_title(
            f"threshold {threshold:g}\n"
            rf"$\beta_0$ = {betti.betti_0} components, $\beta_1$ = {betti.betti_1} holes"
        )
    return figure


def draw_curves() -> Figure:
    """Draw the fractions, the Betti curves and the persistence pairs of the ring."""
    result = tusqh.mesh(broken_ring(), cells=16, betti=(2, 1), bridges="none", scope="global")
    figure, axes = style.new_figure(1, 3, width=10.5, height=3.4)
    _draw_fractions(axes[0, 0], result)
    curves = result.topologies
    for k in range(2):
        axes[0, 1].step(
            np.append(curves["upper"], 0.0),
            np.append(curves[f"betti_{k}"], curves[f"betti_{k}"].iloc[-1]),
            where="post",
            color=style.DIMENSION_COLOURS[k],
            label=rf"$\beta_{k}$: {style.DIMENSION_NAMES[k]}",
        )
    chosen = result.selection
    axes[0, 1].axvspan(*chosen.interval[:2], color="black", alpha=0.08)
    axes[0, 1].axvline(chosen.threshold, color="black", linewidth=0.8)
    axes[0, 1].set_yticks(range(4))
    axes[0, 1].set_xlabel("threshold (volume fraction)")
    axes[0, 1].set_ylabel("number in the mesh")
    axes[0, 1].set_title("two components and one hole: the grey interval")
    axes[0, 1].legend(frameon=False)
    _draw_bars(axes[0, 2], result)
    return figure


def draw_bearing() -> Figure:
    """Draw the bearing of the examples, cut open, at the threshold 1/2 and as it should be."""
    sys.path.insert(0, str(ROOT / "examples"))
    import bearing

    with tempfile.TemporaryDirectory() as folder:
        plain, apart = bearing.main(Path(folder))
    box = plain.geometry.bounding_box()
    figure, axes = style.new_figure(1, 3, width=10.0, height=3.3)
    picture = render(polydata_of(plain.geometry), box, color="#d9c9a3")
    show(axes[0, 0], picture, "the bearing: eleven parts")
    for panel, result, words in (
        (axes[0, 1], plain, "threshold 0.5"),
        (axes[0, 2], apart, f"{apart.built.facts['changed_cells']} cells changed"),
    ):
        half = surface_of(_cut(result.mesh))
        picture = render(half, box, scalars="rgb", rgb=True, **EDGES)
        betti = result.report.measured
        numbers = rf"$\beta_0$ = {betti.betti_0}, $\beta_1$ = {betti.betti_1}"
        show(panel, picture, f"{words}, cut open: {numbers}")
    return figure


def draw_fitted() -> Figure:
    """Draw the dragon, the staircase and the fitted mesh, also cut open by the quality in it."""
    result = tusqh.mesh(
        ROOT / "data_sources/dragon/dragon.off", cells=56, betti=(1, 0, 0), fit=True
    )
    staircase, fitted, box = result.staircase, result.mesh, result.geometry.bounding_box()
    half = grid_of(fitted).cell_quality("scaled_jacobian")
    half = half.clip(normal="x", origin=np.mean(box, axis=0), crinkle=True)
    blue: dict[str, Any] = {"color": style.MATERIAL} | EDGES
    shaded: dict[str, Any] = {
        "scalars": "scaled_jacobian",
        "clim": (0, 1),
        "lighting": False,
        "cmap": "viridis",
    }
    drawn = [
        (polydata_of(result.geometry), {"color": "#d9c9a3"}),
        (surface_of(staircase), blue),
        (surface_of(fitted), blue),
        (half.extract_surface(algorithm=None), shaded | EDGES),
    ]
    pictures = without_margins([render(solid, box, up="y", **look) for solid, look in drawn])
    words = (
        f"an open surface, {len(result.geometry.triangles):,} triangles",
        f"{staircase.n_cells:,} hexes: a staircase",
        f"{fitted.n_cells:,} hexes, fitted",
        "cut open",
    )
    figure, axes = style.new_figure(1, 4, width=11.0, height=3.3)
    for panel, picture, text in zip(axes[0], pictures, words, strict=True):
        show(panel, picture, text)
    mappable = ScalarMappable(Normalize(0, 1), cmap="viridis")
    figure.colorbar(mappable, ax=axes[0, 3], shrink=0.7, label="scaled Jacobian [-]")
    return figure


def draw_gallery() -> Figure:
    """Draw the stack of images and the map of the examples."""
    sys.path.insert(0, str(ROOT / "examples"))
    import porous_stack
    import shapefile_map

    with tempfile.TemporaryDirectory() as folder:
        sand = porous_stack.main(Path(folder) / "sand")
        _, eight = shapefile_map.main(Path(folder) / "hawaii")
    figure, axes = style.new_figure(1, 3, width=10.0, height=3.3)
    box = sand.geometry.bounding_box()
    picture = render(polydata_of(sand.geometry), box, color="#d9c9a3")
    show(axes[0, 0], picture, "voxels of sand in rock")
    picture = render(surface_of(sand.mesh), box, scalars="rgb", rgb=True, **EDGES)
    show(axes[0, 1], picture, f"one body of it: {sand.mesh.n_cells} hexes")
    panel = axes[0, 2]
    style.draw_polygons(
        panel, eight.mesh.points / 1000, eight.mesh.cells, colour=style.MATERIAL, line_width=0.15
    )
    style.draw_outline(panel, eight.geometry, 1000.0)
    grid = eight.fractions.grid
    style.frame(panel, np.divide(grid.origin, 1000), np.divide(grid.upper, 1000), "km")
    panel.set_title(f"eight islands: {eight.mesh.n_cells} quads", fontsize=9)
    return figure


def sheets_and_solids() -> Outline:
    """Return the outline of a disc, a double-sided hull with a slit, clutter and an open sheet."""
    turn = np.linspace(0, 2 * np.pi, 60)
    disc = 0.8 * np.column_stack([np.cos(turn), np.sin(turn)]) + [7.4, 1.0]
    slit = 0.08
    hull = np.array([[0.0, 1 + slit], [0, 2.2], [1.2, 3], [4.8, 3], [5.6, 2.2], [5.6, 0], [0, 0],
                     [0, 1]])  # fmt: skip
    clutter = [
        np.array([[x + 0.5, 1.9], [x, 0.6]])[::way] for x, way in ((1.1, 1), (2.3, -1), (3.5, 1))
    ]
    sheet = np.array([[5.6, 2.2], [8.4, 3.2]])
    return Outline.from_chains([disc, hull, hull[::-1], *clutter, sheet], name="sheets")


def draw_insides() -> Figure:
    """Draw the fractions of an outline of sheets and solids for each way to tell its inside."""
    outline = sheets_and_solids()
    figure, axes = style.new_figure(2, 2, width=9.0, height=4.6)
    words = {
        "winding": "winding: open sheets blur it",
        "envelope": "envelope: slit closed, clutter gone",
        "shell": "shell: all sheets, one cell thick",
        "union": "union: the disc, and all sheets",
    }
    for panel, (inside, title) in zip(axes.ravel(), words.items(), strict=True):
        result = tusqh.mesh(outline, cell_size=0.25, inside=inside, bridges="none")
        grid = result.fractions.grid
        extent = (grid.origin[0], grid.upper[0], grid.origin[1], grid.upper[1])
        panel.imshow(
            result.fractions.cells.T, origin="lower", extent=extent, cmap="Blues", vmin=0, vmax=1
        )
        style.draw_outline(panel, outline, 1.0)
        panel.set_xlim(-0.4, 8.9)
        panel.set_ylim(-0.4, 3.8)
        panel.set_axis_off()
        betti = result.report.measured
        panel.set_title(f"{title}\ncomponents: {betti.betti_0}, holes: {betti.betti_1}")
    return figure


def _cut(mesh: VolumeMesh) -> VolumeMesh:
    """Return the half of a mesh behind the plane through its middle."""
    keep = mesh.points[mesh.cells].mean(axis=1)[:, 1] > 0
    cells, kind, grid_cell = mesh.cells[keep], mesh.kind[keep], mesh.grid_cell[keep]
    return VolumeMesh(mesh.points, cells, kind, grid_cell, mesh.name)


def _draw_quads(panel, result: tusqh.Result) -> None:  # type: ignore[no-untyped-def]
    mesh, grid = result.mesh, result.fractions.grid
    is_template = mesh.kind > 0
    style.draw_polygons(
        panel, mesh.points, mesh.cells[~is_template], colour=style.MATERIAL, line_width=0.4
    )
    style.draw_polygons(
        panel, mesh.points, mesh.cells[is_template], colour=style.SEPARATING, line_width=0.4
    )
    style.frame(panel, grid.origin, grid.upper, "-")
    panel.set_axis_off()


def _draw_fractions(panel, result: tusqh.Result) -> None:  # type: ignore[no-untyped-def]
    grid = result.fractions.grid
    extent = (grid.origin[0], grid.upper[0], grid.origin[1], grid.upper[1])
    drawn = panel.imshow(
        result.fractions.cells.T, origin="lower", extent=extent, cmap="Blues", vmin=0, vmax=1
    )
    style.draw_outline(panel, result.geometry, 1.0)
    panel.set_axis_off()
    panel.set_title("which fraction of each cell is inside")
    panel.figure.colorbar(drawn, ax=panel, label="volume fraction", shrink=0.8)


def _draw_bars(panel, result: tusqh.Result) -> None:  # type: ignore[no-untyped-def]
    pairs = result.diagram.sort_values(["dimension", "birth"], ascending=[True, False])
    pairs = pairs[pairs["persistence"] > 0.02].reset_index(drop=True)
    for k, row in pairs.iterrows():
        colour = style.DIMENSION_COLOURS[int(row["dimension"])]
        panel.plot([row["death"], row["birth"]], [k, k], color=colour, linewidth=2.5)
    panel.axvline(result.selection.threshold, color="black", linewidth=0.8)
    panel.set_yticks([])
    panel.invert_yaxis()
    panel.set_xlabel("threshold (volume fraction)")
    panel.set_title("how long each one lives")


DRAWINGS = {
    "betti_numbers": draw_betti_numbers,
    "thresholds": draw_thresholds,
    "curves": draw_curves,
    "bearing": draw_bearing,
    "gallery": draw_gallery,
    "fitted": draw_fitted,
    "insides": draw_insides,
}


def main() -> None:
    """Draw all pictures, or those that are named."""
    for name in sys.argv[1:] or DRAWINGS:
        path = FOLDER / f"{name}.png"
        style.save(DRAWINGS[name](), path)
        # A palette of 256 colours makes a picture of shaded solids three times smaller.
        with Image.open(path) as picture:
            palette = picture.convert("RGB").quantize(256, dither=Image.Dither.NONE)
        palette.save(path, optimize=True)


if __name__ == "__main__":
    main()
