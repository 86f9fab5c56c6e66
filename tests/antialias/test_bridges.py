"""Archipelagos are joined where the sub-cells allow it, if the mesh confirms the bridge."""

import numpy as np
import pytest
from oracles import betti_by_rank

from tusqh.antialias.bridges import ACCEPTED, NO_ROOM
from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.grid import BackgroundGrid
from tusqh.meshes.betti import betti_by_boundary, betti_by_euler
from tusqh.meshes.checks import check_mesh
from tusqh.meshes.jacobians import element_volumes, smallest_jacobians
from tusqh.meshes.volume_mesh import BRIDGE
from tusqh.readers.files import read_file
from tusqh.sampling.fractions import VolumeFractions, sample_fractions
from tusqh.sampling.layout import lay_grid
from tusqh.settings.policy import Criteria, Policy


def field(kept, interior):
    """Return fractions of 0.75 at kept cells and the given doubled-grid indices, 0.25 elsewhere."""
    kept = np.asarray(kept, dtype=bool)
    values = np.full(tuple(2 * n + 1 for n in kept.shape), 0.25)
    values[1::2, 1::2][kept] = 0.75
    for place in interior:
        values[place] = 0.75
    grid = BackgroundGrid(shape=kept.shape, cell_size=1.0, origin=(0.0, 0.0))
    return VolumeFractions.from_values(grid=grid, samples=4, values=values)


def build(fractions, **policy):
    cells = CellSets(fractions, Policy(**policy)).at(0.5)
    resolved = build_mesh(cells, fractions.grid)
    mesh = resolved.mesh
    assert betti_by_euler(mesh) == betti_by_boundary(mesh) == resolved.cells.predicted
    assert all(check.holds for check in check_mesh(mesh))
    return resolved


# The two cells are three apart along x; the edges between them lie on the line y = 1.
APART = np.zeros((5, 3), dtype=bool)
APART[0, 0] = APART[4, 1] = True
WAY = [(3, 2), (4, 2), (5, 2), (6, 2), (7, 2)]


def test_a_straight_path_joins_two_islands():
    resolved = build(field(APART, WAY))
    assert resolved.cells.predicted == (1, 0, 0)
    row = resolved.cells.bridge_table.iloc[0]
    assert (row["kind"], row["edges"], row["length"], row["status"]) == ("path", 3, 3.0, ACCEPTED)
    mesh = resolved.mesh
    is_bridge = mesh.kind == BRIDGE
    # Four vertices have a ball of four kites, and three edges have two quads.
    assert is_bridge.sum() == 4 * 4 + 3 * 2
    area = element_volumes(mesh.points, mesh.cells)[is_bridge].sum()
    assert area == pytest.approx(22 * 3 / 32)
    scaled = smallest_jacobians(mesh.points, mesh.cells)[1]
    assert scaled.min() >= np.sqrt(0.5) - 1e-12


@pytest.mark.parametrize("missing", WAY)
def test_every_edge_and_inner_vertex_of_a_path_must_be_interior(missing):
    resolved = build(field(APART, [place for place in WAY if place != missing]))
    assert resolved.cells.predicted == (2, 0, 0)
    assert len(resolved.cells.bridge_table) == 0


def test_without_bridges_nothing_is_joined():
    assert build(field(APART, WAY), bridges="none").cells.predicted == (2, 0, 0)


def test_a_path_turns_corners():
    kept = np.zeros((5, 5), dtype=bool)
    kept[0, 0] = kept[4, 4] = True
    way = [(3, 2), (4, 2), (5, 2), (6, 2), (6, 3), (6, 4), (6, 5), (6, 6), (7, 6), (8, 6), (8, 7)]
    resolved = build(field(kept, way))
    assert resolved.cells.predicted == (1, 0, 0)
    assert resolved.cells.bridge_table["edges"].tolist() == [6]


def test_the_prototypes_fault_a_speck_beside_an_exterior_pinch_stays():
    """Its pinch vertex fails the threshold, although both adjacent edges pass."""
    kept = np.zeros((4, 4), dtype=bool)
    kept[:2, :2] = kept[2, 2] = True
    edges = [(5, 4), (4, 3)]  # These are around one empty cell.
    few = {"components": Criteria(min_cells=2)}
    lost = build(field(kept, edges), bridges="none", **few)
    assert lost.cells.n_removed == 1
    resolved = build(field(kept, edges), **few)
    assert resolved.cells.n_removed == 0
    assert resolved.cells.predicted == (1, 0, 0)
    assert resolved.cells.bridge_table["kind"].tolist() == ["pinch"]
    # Edges on different sides lead around no empty cell.
    across = build(field(kept, [(5, 4), (3, 4)]), **few)
    assert across.cells.n_removed == 1


def test_a_forest_makes_no_hole_and_all_may():
    """There are two ways between the two bars."""
    kept = np.zeros((9, 4), dtype=bool)
    kept[:, 0] = kept[:, 3] = True
    ways = [(x, y) for x in (4, 14) for y in (3, 4, 5)]
    forest = build(field(kept, ways))
    assert forest.cells.predicted == (1, 0, 0)
    both = build(field(kept, ways), bridges="all")
    assert both.cells.predicted == (1, 1, 0)
    assert both.cells.n_bridges == 2


def test_a_path_through_the_middle_of_another_one_is_reported():
    """Three islands around a fork; the two nearer ones are joined first, through the fork."""
    kept = np.zeros((4, 4), dtype=bool)
    kept[0, 0] = kept[3, 0] = kept[2, 3] = True
    fork = build(field(kept, [(3, 2), (4, 2), (5, 2), (4, 3), (4, 4), (4, 5)]))
    assert fork.cells.predicted == (2, 0, 0)
    assert fork.cells.bridge_table["status"].tolist() == [ACCEPTED, NO_ROOM]


def test_a_connecting_pinch_beside_a_path_leaves_room_for_it():
    kept = np.zeros((5, 4), dtype=bool)
    kept[0, 0] = kept[3, 1] = kept[4, 1] = kept[2, 2] = True
    crowded = build(field(kept, [*WAY[:3], (6, 4)]))  # The pinch at (6, 4) connects.
    assert crowded.cells.predicted == (1, 0, 0)
    assert crowded.cells.bridge_table["status"].tolist() == [ACCEPTED]


@pytest.mark.parametrize("mode", ["forest", "all"])
@pytest.mark.parametrize("start", range(0, 600, 150))
def test_random_archipelagos(start, mode):
    n_paths = n_pinches = 0
    for seed in range(start, start + 150):
        rng = np.random.default_rng(seed)
        shape = tuple(int(n) for n in rng.integers(2, 12, 2))
        is_interior = rng.random(tuple(2 * n + 1 for n in shape)) < rng.uniform(0.2, 1.0)
        kept = rng.random(shape) < rng.uniform(0.05, 0.5)
        fractions = field(kept, [tuple(p) for p in np.argwhere(is_interior) if (p % 2 == 0).any()])
        plain = CellSets(fractions, Policy(bridges="none")).at(0.5)
        resolved = build(fractions, bridges=mode)
        assert betti_by_rank(resolved.mesh.cells) == resolved.cells.predicted, seed
        scaled = smallest_jacobians(resolved.mesh.points, resolved.mesh.cells)[1]
        assert scaled.min(initial=1.0) >= np.sqrt(0.5) - 1e-12, seed
        table = resolved.cells.bridge_table
        if mode == "forest":
            fell = plain.predicted.betti_0 - resolved.cells.predicted.betti_0
            assert fell == resolved.cells.n_bridges, seed
            assert resolved.cells.predicted.betti_1 == plain.predicted.betti_1, seed
        n_paths += (table["kind"] == "path").sum()
        n_pinches += (table["kind"] == "pinch").sum()
    assert n_paths > 50
    assert n_pinches > 10


def test_the_papers_wedge_is_one_piece_and_the_gap_is_open(repository):
    folder = repository / "data_sources/analytic"
    wedge = read_file(folder / "wedge.svg").geometry
    window = ((0.0, -20.0), (80.0, 2.0))
    grid = lay_grid(wedge, window, cell_size=1.0)
    fractions = sample_fractions(wedge, grid, window=window)
    assert build(fractions, bridges="none").cells.predicted == (5, 0, 0)
    assert build(fractions).cells.predicted == (1, 0, 0)
    gap = read_file(folder / "gap.svg").geometry
    fractions = sample_fractions(gap, lay_grid(gap, None, cells=26))
    resolved = build(fractions)
    assert resolved.cells.n_contacts > 15
    assert resolved.cells.predicted == (2, 0, 0)
