"""Fractions in the cells of a background: those of the grid, volumes, refused settings."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from backgrounds import split_lattice
from test_listed_complex import as_background

from tusqh.background.fractions import sample_background
from tusqh.background.makers import make_box, make_cylinder, make_layers
from tusqh.background.scattered import ScatteredField
from tusqh.errors import ConfigError, MeshError, SamplingError
from tusqh.geometry.image import Image
from tusqh.geometry.outline import Outline
from tusqh.geometry.soup import Soup
from tusqh.grid import BackgroundGrid
from tusqh.sampling.fractions import sample_fractions
from tusqh.settings.sampling import Sampling


def as_soup(mesh, keep=slice(None)):
    faces = np.asarray(mesh.faces, dtype=np.int64)[keep]
    return Soup(np.asarray(mesh.vertices), faces, np.zeros(len(faces), dtype=np.int64), name="ball")


def ball(keep=slice(None)):
    return as_soup(trimesh.creation.icosphere(subdivisions=2), keep)


def star():
    angle = np.linspace(0, 2 * np.pi, 12)
    radius = np.where(np.arange(12) % 2, 1.0, 0.5)
    return Outline.from_chains([np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)])


@pytest.mark.parametrize("geometry", [star(), ball()], ids=["star", "ball"])
@pytest.mark.parametrize("samples", [2, 4])
def test_a_grid_as_background_has_the_fractions_of_the_grid(geometry, samples):
    dim = len(geometry.bounding_box()[0])
    grid = BackgroundGrid(shape=(9, 8, 7)[:dim], cell_size=0.3, origin=(-1.3, -1.1, -1.2)[:dim])
    on_grid = sample_fractions(geometry, grid, sampling=Sampling(samples=samples)).values
    box = make_box(grid.origin, grid.upper, grid.shape)
    ours = sample_background(geometry, box, sampling=Sampling(samples=samples)).values
    _, theirs = as_background(on_grid)
    # The same sample points: equal to the last digit, except on the rim, which has no value.
    assert (ours.cells == theirs.cells).all()
    numbered = as_background(on_grid)[0]
    assert (numbered.edge_ends == box.edge_ends).all()
    inside = ~box.is_rim_vertex
    assert (ours.vertices[inside] == theirs.vertices[inside]).all()
    assert (ours.edges[~box.is_rim_edge] == theirs.edges[~box.is_rim_edge]).all()


def test_an_open_surface_agrees_with_the_grid_within_its_tolerance():
    gapped = ball(np.arange(320) % 11 > 0)
    grid = BackgroundGrid(shape=(8, 8, 8), cell_size=0.28, origin=(-1.12,) * 3)
    on_grid = sample_fractions(gapped, grid).cells
    ours = sample_background(gapped, make_box(grid.origin, grid.upper, grid.shape)).cells
    assert np.abs(ours - on_grid.ravel()).max() < 3e-6


@pytest.mark.parametrize(
    "background",
    [make_cylinder((0, 0, -1.2), 1.5, 2.4), make_layers((-2,) * 3, (2,) * 3, (12, 12, 16))],
    ids=["cylinder", "layers"],
)
def test_the_fractions_add_up_to_the_volume(background):
    fractions = sample_background(ball(), background, sampling=Sampling(samples=6))
    exact = trimesh.creation.icosphere(subdivisions=2).volume
    assert fractions.volume() == pytest.approx(exact, rel=4e-3)
    outside = Sampling(samples=6, domain="outside")
    rest = sample_background(ball(), background, sampling=outside)
    assert rest.volume() + fractions.volume() == pytest.approx(background.volumes.sum(), rel=1e-5)


def test_inside_out_doubled_and_clamped_geometries_are_sampled_as_on_a_grid():
    box = make_box((-1.2,) * 3, (1.2,) * 3, (6, 6, 6))
    plain = sample_background(ball(), box).values.cells
    turned = replace(ball(), triangles=ball().triangles[:, ::-1])
    assert (sample_background(turned, box).values.cells == plain).all()
    twice = Soup(ball().points, np.tile(ball().triangles, (2, 1)), np.zeros(640, dtype=np.int64))
    assert (sample_background(twice, box).values.cells == 2 * plain).all()
    clamped = sample_background(twice, box, sampling=Sampling(rule="clamped")).values.cells
    assert (clamped == plain).all()


def test_rays_count_what_the_solid_angles_sum():
    geometry, rng = ball(), np.random.default_rng(0)
    points = rng.uniform(-1.3, 1.3, (4000, 3))
    by_rays = ScatteredField.of(geometry)
    by_angles = ScatteredField(by_rays.cap, by_rays.cycle, False)
    assert np.abs(by_rays.at(points) - by_angles.at(points)).max() < 1e-9
    # Rays through vertices and edges count once.
    lattice = np.stack(np.meshgrid(*[np.linspace(-1, 1, 21)] * 3, indexing="ij"), -1).reshape(-1, 3)
    cube = ScatteredField.of(as_soup(trimesh.creation.box((1.0, 1.0, 1.0))))
    inside = (np.abs(lattice) < 0.499).all(axis=1)
    beyond = (np.abs(lattice) > 0.501).any(axis=1)
    assert (cube.at(lattice)[inside] == 1).all()
    assert (cube.at(lattice)[beyond] == 0).all()


def test_the_fractions_of_split_tetrahedra_are_means_by_volume():
    background = split_lattice()
    slab = as_soup(trimesh.creation.box(bounds=[[-1, -1, -1], [3, 3, 0.9]]))
    fractions = sample_background(slab, background, sampling=Sampling(samples=8))
    top = background.points[background.cells][..., 2]
    assert (fractions.cells[(top < 0.9).all(axis=1)] == 1).all()
    assert (fractions.cells[(top > 0.9).all(axis=1)] == 0).all()
    below = background.points[:, 2] < 0.9
    vertices = fractions.values.vertices
    assert vertices[below].mean() > 10 * vertices[~below].mean()


def test_what_is_not_available_with_a_background_is_refused():
    box = make_box((-2,) * 3, (2,) * 3, (4, 4, 4))
    for sampling in (
        Sampling(inside="envelope"),
        Sampling(inside="shell"),
        Sampling(sampler="libigl"),
    ):
        with pytest.raises(ConfigError, match="with a background mesh"):
            sample_background(ball(), box, sampling=sampling)
    with pytest.raises(ConfigError, match="image"):
        sample_background(Image(np.ones((4, 4, 4)), name="block"), box)
    with pytest.raises(MeshError, match="misses the geometry"):
        sample_background(ball(), make_box((5,) * 3, (6,) * 3, (2, 2, 2)))
    with pytest.raises(SamplingError, match="positive fraction"):
        sample_background(ball(), make_box((0.9,) * 3, (0.99,) * 3, (2, 2, 2)))
