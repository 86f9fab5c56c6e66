"""A call of `tusqh.mesh` computes nothing twice and nothing that was not requested."""

import sys
from collections import Counter

import pytest
import trimesh

import tusqh
from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.meshes.betti import betti_by_boundary, betti_by_euler
from tusqh.meshes.checks import check_mesh
from tusqh.meshes.facets import find_facets
from tusqh.meshes.jacobians import element_volumes, smallest_jacobians
from tusqh.pipeline.ingest import describe_geometry
from tusqh.topology.curves import tabulate_curves
from tusqh.topology.pairs import tabulate_pairs
from tusqh.topology.union_find import merge_components

GOALS = {
    "threshold": {"threshold": 0.5},
    "target": {"betti": (1, 1, 0)},
    "persistence": {"persistence": 0.3},
    "volume": {"volume": "match"},
    "criteria": {"threshold": 0.5, "components": {"min_persistence": 0.1}},
}


class Calls:
    """Count the calls of functions, regardless of the names they were imported by."""

    def __init__(self, *functions):
        self.names = {function.__code__: function.__name__ for function in functions}
        self.counts = Counter()
        self.facets_of = Counter()
        self.kept_alive = []

    def __enter__(self):
        sys.setprofile(self._note)
        return self

    def __exit__(self, *reason):
        sys.setprofile(None)

    def _note(self, frame, event, argument):
        name = self.names.get(frame.f_code) if event == "call" else None
        if name is not None:
            self.counts[name] += 1
        if name == "find_facets":
            cells = frame.f_locals["cells"]
            self.kept_alive.append(cells)  # Keep the array, so that no other array gets its id.
            self.facets_of[id(cells)] += 1


@pytest.fixture(scope="module")
def torus():
    return trimesh.creation.torus(10.0, 3.5, major_sections=24, minor_sections=12)


@pytest.mark.parametrize("goal", GOALS)
def test_every_fact_is_computed_once(torus, goal):
    with Calls(
        build_mesh,
        find_facets,
        check_mesh,
        betti_by_euler,
        betti_by_boundary,
        smallest_jacobians,
        element_volumes,
        merge_components,
        tabulate_curves,
        describe_geometry,
        tabulate_pairs,
        CellSets.at,
    ) as calls:
        result = tusqh.mesh(torus, cells=10, **GOALS[goal])
    counts = calls.counts
    assert set(calls.facets_of.values()) == {1}
    n_meshes = len(result.choice.candidates) if goal == "volume" else 1
    for name in ("build_mesh", "check_mesh", "betti_by_euler", "betti_by_boundary"):
        assert counts[name] == n_meshes, name
    for name in ("smallest_jacobians", "element_volumes"):
        assert counts[name] == n_meshes, name
    assert counts["merge_components"] <= 2
    assert counts["tabulate_curves"] == ("threshold" not in GOALS[goal])
    assert counts["describe_geometry"] == 0
    assert counts["tabulate_pairs"] == (goal == "persistence")
    assert counts["at"] == n_meshes


def test_tables_are_computed_once_when_they_are_asked_for(torus):
    result = tusqh.mesh(torus, cells=10)
    with Calls(describe_geometry, tabulate_pairs, CellSets.at, merge_components) as calls:
        for name in ("defects", "diagram", "curves", "topologies"):
            assert getattr(result, name) is getattr(result, name)
    assert calls.counts["describe_geometry"] == calls.counts["tabulate_pairs"] == 1
    assert calls.counts["at"] == 0
    assert calls.counts["merge_components"] == 2
