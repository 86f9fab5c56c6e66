"""Contacts in 3D: every material a manifold, with the predicted Betti numbers."""

import numpy as np
import pytest
from oracles import gudhi_betti
from random_materials import random_materials

from tusqh.contacts.mesh import mesh_materials

#: The bound of the 1-7 template on cubic cells.
BOUND = 1 / np.sqrt(3) - 1e-12


def check_materials(found, case):
    """Compare every material, the void and the solid with the prediction, by two counts."""
    assert found.mesh.measurement.is_sound, case
    assert found.is_as_predicted, case
    assert found.mesh.measurement.smallest_scaled_jacobian >= BOUND, case
    present = set(found.measured)
    assert {name for name, betti in found.predicted.items() if betti.betti_0} == present


def check_fields(seeds, largest=5):
    n_contacts = n_overruled = 0
    for seed in seeds:
        fractions, thresholds = random_materials(seed, 3, largest)
        found = mesh_materials(fractions, thresholds=thresholds, with_void=True)
        check_materials(found, seed)
        n_contacts += found.n_contacts
        n_overruled += found.n_overruled
    return n_contacts, n_overruled


def test_random_fields():
    n_contacts, n_overruled = check_fields(range(25), largest=4)
    assert n_contacts > 300
    assert n_overruled < 0.05 * n_contacts


@pytest.mark.slow
def test_1500_random_fields():
    n_contacts, n_overruled = check_fields(range(100, 1600))
    assert n_contacts > 30_000
    assert n_overruled < 0.05 * n_contacts


def test_materials_against_a_simplicial_complex():
    """The same numbers from the barycentric subdivision of the hexes of each material."""
    for seed in range(4):
        fractions, thresholds = random_materials(seed, 3, 3)
        found = mesh_materials(fractions, thresholds=thresholds)
        for name, measured in found.measured.items():
            assert gudhi_betti(measured.mesh.cells) == found.predicted[name], (seed, name)
