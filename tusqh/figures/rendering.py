"""Render pictures of meshes and surfaces in space off-screen with pyvista."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from tusqh.figures import style
from tusqh.geometry.image import Image
from tusqh.geometry.soup import Soup
from tusqh.geometry.upright import Axis
from tusqh.grid import FloatArray, IntArray
from tusqh.meshes.volume_mesh import BRIDGE, CONNECTING, SEPARATING, SIDE_BALL, VolumeMesh
from tusqh.quality.system_libraries import check_rendering

#: Colours by `VolumeMesh.kind`.
_COLOURS = {
    SEPARATING: style.SEPARATING,
    CONNECTING: style.CONNECTING,
    BRIDGE: style.BRIDGE,
    SIDE_BALL: style.SEPARATING,
}

#: Direction from the centre of the model to the camera: to the right, to the front, upwards.
VIEW = (1.0, 1.6, 0.9)

#: Directions to the right, to the front and upwards, by the axis that points up.
FRAMES = {
    "x": ((0, 1, 0), (0, 0, -1), (1, 0, 0)),
    "y": ((1, 0, 0), (0, 0, 1), (0, 1, 0)),
    "z": ((1, 0, 0), (0, -1, 0), (0, 0, 1)),
}

#: Look of the elements' edges: light enough for the colour of the elements to be seen.
EDGES: dict[str, Any] = {"show_edges": True, "edge_color": style.ELEMENT_EDGE, "line_width": 1}

#: Edges of more elements than this would hide their colours.
EDGES_BELOW = 60_000

#: Light from all directions and from one lamp, so that sides in the shade keep their colour.
_LIGHT = {"ambient": 0.5, "diffuse": 0.55, "specular": 0.0}

#: Direction from the centre of the model to the lamp: to the right, to the front, upwards.
_LAMP = (-0.3, 0.75, 1.0)


def grid_of(mesh: VolumeMesh) -> Any:
    """Return a hex mesh as a pyvista grid with its kinds of elements in ``kind``.

    Parameters
    ----------
    mesh
        The mesh.
    """
    import pyvista

    grid = pyvista.UnstructuredGrid({12: mesh.cells}, mesh.points)
    grid.cell_data["kind"] = mesh.kind
    return grid


def surface_of(mesh: VolumeMesh) -> Any:
    """Return the boundary of a hex mesh as a pyvista surface with its colours in ``rgb``.

    Parameters
    ----------
    mesh
        The mesh.
    """
    from matplotlib.colors import to_rgb

    grid = grid_of(mesh)
    colours = np.tile(to_rgb(style.MATERIAL), (mesh.n_cells, 1))
    for kind, colour in _COLOURS.items():
        colours[mesh.kind == kind] = to_rgb(colour)
    grid.cell_data["rgb"] = (255 * colours).astype(np.uint8)
    return grid.extract_surface(pass_pointid=False, pass_cellid=False, algorithm=None)


def polydata_of(geometry: Soup | Image) -> Any:
    """Return a soup, or the faces between full and empty voxels, as a pyvista surface.

    Parameters
    ----------
    geometry
        The soup or image.
    """
    import pyvista

    if isinstance(geometry, Image):
        grid = pyvista.ImageData(
            dimensions=np.add(geometry.shape, 1),
            spacing=(geometry.voxel_size,) * 3,
            origin=geometry.origin,
        )
        grid.cell_data["fraction"] = geometry.fractions().ravel(order="F")
        kept = grid.threshold(0.5, scalars="fraction")
        return kept.extract_surface(pass_pointid=False, pass_cellid=False, algorithm=None)
    n = len(geometry.triangles)
    faces = np.column_stack([np.full(n, 3), geometry.triangles]).ravel()
    return pyvista.PolyData(geometry.points, faces=faces)


def field_on(points: FloatArray, cells: IntArray, field: FloatArray, origin: FloatArray) -> Any:
    """Return the half of a hex mesh behind a plane, with a field at its points.

    Parameters
    ----------
    points
        Coordinates, shape (n, 3).
    cells
        Hexes, shape (m, 8).
    field
        Values at the points, shape (n,).
    origin
        A point of the plane, shape (3,); the plane is normal to y.
    """
    import pyvista

    grid = pyvista.UnstructuredGrid({12: cells}, points)
    grid.point_data["field"] = field
    half = grid.clip(normal=(0, -1, 0), origin=origin, crinkle=True)
    return half.extract_surface(pass_pointid=False, pass_cellid=False, algorithm=None)


def render(
    surface: Any,
    box: Any,
    *,
    up: Axis = "z",
    size: tuple[int, int] = (960, 840),
    labels: Mapping[str, FloatArray] | None = None,
    **look: Any,
) -> Any:
    """Return a picture of a surface on a white background, shape (height, width, 3), uint8.

    Parameters
    ----------
    surface
        A pyvista surface; None: an empty picture.
    box
        Lowest and highest corner of the box that the camera frames.
    up
        Axis that points up.
    size
        Width and height in pixels.
    labels
        Places by the text that is written there, over everything else.
    **look
        Options of `pyvista.Plotter.add_mesh`.

    Raises
    ------
    SystemLibraryError
        The system has no library to render with.
    """
    import pyvista

    check_rendering()
    plotter: Any = pyvista.Plotter(off_screen=True, window_size=list(size), lighting="none")
    plotter.set_background("white")
    if surface is not None and surface.n_cells:
        plotter.add_mesh(surface, show_scalar_bar=False, **(_LIGHT | look))
    if labels:
        plotter.add_point_labels(
            np.array(list(labels.values())),
            list(labels),
            always_visible=True,
            show_points=False,
            font_size=22,
            text_color="black",
            shape_color="white",
            shape_opacity=0.8,
        )
    low, high = np.asarray(box[0]), np.asarray(box[1])
    centre, extent = (low + high) / 2, float(np.linalg.norm(high - low))
    towards = np.array(VIEW) @ np.array(FRAMES[up]) / np.linalg.norm(VIEW)
    upwards = FRAMES[up][2]
    plotter.add_light(
        pyvista.Light(position=np.array(_LAMP) @ np.array(FRAMES[up]), light_type="scene light")
    )
    right = np.cross(upwards, towards)
    right /= np.linalg.norm(right)
    # Use the smallest view that contains the box.
    corners = np.array(list(itertools.product(*np.stack([low, high], axis=1)))) - centre
    wide, tall = (np.abs(corners @ axis).max() for axis in (right, np.cross(towards, right)))
    plotter.camera_position = [centre + 3 * extent * towards, centre, upwards]
    plotter.camera.parallel_projection = True
    plotter.camera.parallel_scale = 1.04 * max(tall, wide * size[1] / size[0])
    plotter.renderer.ResetCameraClippingRange()
    image = plotter.screenshot(return_img=True)
    plotter.close()
    return image


def without_margins(pictures: Sequence[Any]) -> list[Any]:
    """Return pictures of one size without the white margin that all of them have.

    Parameters
    ----------
    pictures
        The pictures, shape (height, width, 3) each, uint8.
    """
    is_drawn = np.any([(picture < 255).any(axis=2) for picture in pictures], axis=0)
    if not is_drawn.any():
        return list(pictures)
    rows, columns = (np.flatnonzero(is_drawn.any(axis=axis)) for axis in (1, 0))
    height, width = (slice(places[0], places[-1] + 1) for places in (rows, columns))
    return [picture[height, width] for picture in pictures]


def show(axes: Axes, image: Any, title: str) -> None:
    """Put a picture into a panel without axes.

    Parameters
    ----------
    axes
        The panel.
    image
        The picture, shape (height, width, 3).
    title
        The title of the panel.
    """
    axes.imshow(image)
    axes.set_axis_off()
    axes.set_title(title, fontsize=9)
