"""The figure of several materials names each and shows it in its colour, at its place."""

import numpy as np
import pytest
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_hex
from needs import require_rendering

import tusqh
from tusqh.figures.material_colours import material_colours
from tusqh.figures.materials import draw_materials
from tusqh.meshes.regions import Regions


def areas_by_colour(axes):
    """Return the area that is filled with each colour, by the shoelace formula."""
    found = {}
    for drawn in axes.collections:
        if not isinstance(drawn, PolyCollection):
            continue
        colours = drawn.get_facecolor()
        for k, path in enumerate(drawn.get_paths()):
            (x, y), colour = path.vertices[:-1].T, to_hex(colours[k % len(colours)])
            area = abs(x @ np.roll(y, 1) - y @ np.roll(x, 1)) / 2
            found[colour] = found.get(colour, 0) + area
    return found


@pytest.mark.parametrize("up", ["y", "z"])
def test_the_section_of_a_solid_has_the_area_of_every_material(up):
    """Cells of 0.5 mm, without contacts: the areas are counted in the image of labels."""
    require_rendering()
    image = np.zeros((6, 7, 5), dtype=np.uint8)
    image[1:5, 1:6, 1:4], image[2:4, 2:5, 2] = 1, 2
    found = tusqh.mesh(image, image={"voxel_size": 0.5}, materials={1: "bone", 2: "marrow"})
    regions = Regions(found.names, found.built.material)
    figure = draw_materials(found.mesh, regions, unit="mm", up=up)
    panel = figure.axes[2]
    middle = image[:, 3] if up == "z" else image[:, :, 2]
    assert panel.get_title().startswith(f"section at {'y' if up == 'z' else 'z'} = ")
    assert panel.get_xlabel() == "x [mm]"
    assert panel.get_ylabel() == ("z [mm]" if up == "z" else "y [mm]")
    expected = {c: 0.25 * (middle == k).sum() for k, c in enumerate(material_colours(2), 1)}
    assert areas_by_colour(panel) == pytest.approx(expected)
    (legend,) = figure.legends
    counts = [(image == k).sum() for k in (1, 2)]
    assert [t.get_text() for t in legend.get_texts()] == [
        f"bone ({counts[0]})", f"marrow ({counts[1]})"
    ]  # fmt: skip
    assert "whole, 2 x 2.5 x 1.5 mm" in figure.axes[0].get_title()


def test_a_map_has_kilometres_and_the_area_of_every_material():
    image = np.ones((4, 3), dtype=np.uint8)
    image[1:3] = 2
    found = tusqh.mesh(image, image={"voxel_size": 5000.0}, materials="labels")
    figure = draw_materials(found.mesh, Regions(found.names, found.built.material), unit="m")
    (panel,) = figure.axes
    assert panel.get_xlabel() == "x [km]"
    expected = dict(zip(material_colours(2), (150.0, 150.0), strict=True))
    assert areas_by_colour(panel) == pytest.approx(expected)
