"""The mesh of random kept cells with random, independent decisions of every pinch."""

import numpy as np
import pytest
from backgrounds import backgrounds, random_values
from oracles import betti_by_rank, gudhi_betti

from tusqh.background.cells import BackgroundCells, BackgroundCellSets
from tusqh.background.curves import BackgroundTopology
from tusqh.background.makers import make_box
from tusqh.background.mesh import build_mesh
from tusqh.background.node_values import NodeValues
from tusqh.background.pinches import find_pinches
from tusqh.meshes.betti import betti_by_boundary, betti_by_euler
from tusqh.meshes.manifold import find_non_manifold_points
from tusqh.meshes.numbering import number_rows
from tusqh.topology.clamping import FULL

NAMES = ["box", "cylinder", "lattice", "triangles"]


@pytest.fixture(scope="module")
def meshes():
    return backgrounds()


def random_cells(rng, background, *, to_rim=True):
    """Return random kept cells, each of whose pinches decides for itself."""
    kept = rng.random(background.n_cells) < rng.choice([0.1, 0.3, 0.5, 0.7, 0.9])
    if not to_rim:
        kept &= ~background.is_rim_vertex[background.cells].any(axis=1)
    sizes = background.n_edges, background.n_points
    votes = [(rng.integers(0, 2, n) * FULL).astype(np.int32) for n in sizes]
    values = NodeValues(np.where(kept, FULL, 0).astype(np.int32), *votes)
    topology = BackgroundTopology(background, values)
    pinches = find_pinches(background, kept)
    return BackgroundCells(
        background,
        kept,
        pinches,
        topology.values.vertices[pinches.vertices] > 0,
        topology.values.edges[pinches.edges] > 0,
        topology.betti_at(0.5),
    )


def require_as_predicted(cells, mesh):
    """Check that a mesh is a manifold with the predicted topology, by two counts."""
    assert len(find_non_manifold_points(mesh.facets)) == 0
    assert mesh.facets.n_cells_of.max(initial=0) <= 2
    assert number_rows(mesh.cells, np.arange(mesh.cells.shape[1])[None])[1] == mesh.n_cells
    assert betti_by_euler(mesh) == betti_by_boundary(mesh) == cells.predicted


def run_trials(background, n, seed):
    rng, n_pinches = np.random.default_rng(seed), np.zeros(2, dtype=int)
    for k in range(n):
        cells = random_cells(rng, background, to_rim=k % 2 == 0)
        if cells.kept.any():
            mesh, *_ = build_mesh(cells, name="trial")
            require_as_predicted(cells, mesh)
            n_pinches += len(cells.pinches.vertices), len(cells.pinches.edges)
    return n_pinches


@pytest.mark.parametrize("name", NAMES)
def test_random_decisions_give_the_predicted_manifold(meshes, name):
    n_vertices, n_edges = run_trials(meshes[name], 60, 7)
    assert n_vertices > 400
    assert (n_edges > 400) == (name != "triangles")


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_a_thousand_random_decisions_give_the_predicted_manifold(meshes, name):
    n_vertices, n_edges = run_trials(meshes[name], 1000, 11)
    print(f"{name}: {n_vertices} pinch vertices, {n_edges} pinch edges")


@pytest.mark.parametrize("name", NAMES)
def test_other_counts_of_the_mesh_agree(meshes, name):
    background, rng = meshes[name], np.random.default_rng(5)
    count = gudhi_betti if background.dim == 3 else betti_by_rank
    for _ in range(2):
        cells = random_cells(rng, background, to_rim=False)
        mesh, *_ = build_mesh(cells, name="trial")
        assert tuple(count(mesh.cells)) == tuple(cells.predicted)


@pytest.mark.parametrize("name", NAMES)
def test_every_threshold_has_the_mesh_that_its_diagram_predicts(meshes, name):
    background, rng = meshes[name], np.random.default_rng(9)
    for _ in range(3):
        sets = BackgroundCellSets(background, random_values(rng, background))
        for level in sets.topology.curves["upper"]:
            cells = sets.at(level)
            if cells.kept.any():
                require_as_predicted(cells, build_mesh(cells, name="trial")[0])


def test_pinches_are_found_by_their_definition(meshes):
    for background in meshes.values():
        rng = np.random.default_rng(4)
        for _ in range(5):
            kept = rng.random(background.n_cells) < rng.random()
            found = find_pinches(background, kept)
            assert found.vertices.tolist() == pinch_vertices(background, kept)
            assert set(background.edge_ends[found.edges].ravel()) <= set(found.vertices)


def pinch_vertices(background, kept):
    """Return the pinch vertices, by a search through facets at each vertex."""
    found = []
    for v in range(background.n_points):
        around = [*np.flatnonzero((background.cells == v).any(axis=1)).tolist()]
        facets = np.flatnonzero((background.vertices_of_facets == v).any(axis=1))
        pairs = background.facet_cells[facets].tolist()
        states = dict.fromkeys(around, False) | {c: bool(kept[c]) for c in around}
        if background.is_rim_vertex[v]:
            states[-1] = False
        if any(n_parts([c for c in states if states[c] == s], pairs) > 1 for s in (True, False)):
            found.append(v)
    return found


def n_parts(members, pairs):
    parent = {m: m for m in members}

    def root(m):
        while parent[m] != m:
            m = parent[m]
        return m

    for a, b in pairs:
        if a in parent and b in parent:
            parent[root(a)] = root(b)
    return len({root(m) for m in members})


def test_two_hexes_at_an_edge_are_joined_by_its_stick_or_parted():
    box = make_box((0, 0, 0), (4, 4, 4), (4, 4, 4))
    kept = np.zeros((4, 4, 4), dtype=bool)
    kept[1, 1, 1] = kept[2, 2, 1] = True
    for votes, betti in (((0, 0), (2, 0, 0)), ((0, FULL), (1, 0, 0)), ((FULL, 0), (1, 1, 0))):
        sizes = box.n_points, box.n_edges
        vertices, edges = (np.full(n, v, dtype=np.int32) for n, v in zip(sizes, votes, strict=True))
        values = NodeValues(np.where(kept, FULL, 0).ravel().astype(np.int32), edges, vertices)
        cells = BackgroundCellSets(box, values).at(0.5)
        assert (len(cells.pinches.vertices), len(cells.pinches.edges)) == (2, 1)
        mesh, is_new, _ = build_mesh(cells, name="two")
        require_as_predicted(cells, mesh)
        assert tuple(cells.predicted) == betti
        assert is_new.any()
