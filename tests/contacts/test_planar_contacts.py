"""With contacts in 2D, every material is a manifold with the predicted Betti numbers."""

import itertools

import numpy as np
import pytest
from oracles import betti_by_rank
from random_materials import random_materials

from tusqh.contacts.mesh import mesh_materials
from tusqh.contacts.planar import find_diagonals
from tusqh.contacts.voxel_fractions import fractions_of_labels

#: The bound of the 1-5 template on square cells.
BOUND = np.sqrt(0.5) - 1e-12


def check_materials(found, case):
    """Compare every material, the void and the solid with the prediction, by three counts."""
    assert found.mesh.measurement.is_sound, case
    assert found.is_as_predicted, case
    assert all(measured.n_non_manifold == 0 for measured in found.measured.values()), case
    for name in found.measured:
        assert betti_by_rank(found.part(name).cells) == found.predicted[name], case
    assert found.mesh.measurement.smallest_scaled_jacobian >= BOUND, case
    present = set(found.measured)
    assert {name for name, betti in found.predicted.items() if betti.betti_0} == present


def labellings():
    """Return the 15 labellings of four cells up to names."""
    every = itertools.product(range(1, 5), repeat=4)
    return [c for c in every if all(k <= 1 + max(c[:i], default=0) for i, k in enumerate(c))]


def test_all_15_labellings_of_a_vertex():
    assert len(labellings()) == 15
    n_pinched = 0
    for cells in labellings():
        found = mesh_materials(fractions_of_labels(np.reshape(cells, (2, 2))), with_void=True)
        check_materials(found, cells)
        cyclic = np.array(cells)[[0, 2, 3, 1]]
        assert found.n_contacts == find_diagonals(cyclic)
        n_pinched += found.n_contacts
    assert n_pinched == 3  # Both diagonals of two materials, or one and two others.


def check_fields(seeds):
    n_pinched = 0
    for seed in seeds:
        fractions, thresholds = random_materials(seed, 2, 12)
        found = mesh_materials(fractions, thresholds=thresholds, with_void=True)
        check_materials(found, seed)
        assert found.n_overruled == 0
        n_pinched += found.n_contacts
    return n_pinched


def test_random_fields():
    assert check_fields(range(500)) > 2_000


@pytest.mark.slow
def test_3000_random_fields():
    assert check_fields(range(500, 3500)) > 15_000


def test_a_ball_has_the_material_with_the_best_fraction_at_its_vertex():
    """Four cells of two materials form a cross, and the sub-cell in the middle decides."""
    for winner in (0, 1):
        image = np.array([[1, 2], [2, 1]]).repeat(4, 0).repeat(4, 1)
        # The winner has one more voxel close to the vertex.
        image[(3, 3) if winner == 1 else (3, 4)] = 2 if winner == 1 else 1
        found = mesh_materials(fractions_of_labels(image, voxels_per_cell=4))
        joined = [found.predicted[name].betti_0 == 1 for name in ("1", "2")]
        assert joined == [winner == 0, winner == 1]
