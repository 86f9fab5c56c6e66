"""Random fields of several materials with ties, contradictory sub-cells and full boxes."""

import numpy as np

from tusqh.contacts.material_fractions import FULL, MaterialFractions
from tusqh.grid import BackgroundGrid


def random_materials(seed, dim, largest):
    """Return fractions of 2 to 6 materials (void among them) on a small grid, and thresholds."""
    rng = np.random.default_rng(seed)
    shape = tuple(int(n) for n in rng.integers(2, largest + 1, dim))
    m = int(rng.integers(1, 6))
    places = tuple(2 * n + 1 for n in shape)
    kind = seed % 5
    if kind == 0:
        fields = rng.random((m + 1, *places))
    elif kind == 1:  # This field has many ties.
        fields = rng.integers(0, 3, (m + 1, *places)).astype(float)
    elif kind == 2:  # Every place has one material, independent of its neighbours.
        fields = np.moveaxis(np.eye(m + 1)[rng.integers(0, m + 1, places)], -1, 0)
    elif kind == 3:  # There is no void, because the labels fill the box.
        fields = rng.random((m + 1, *places))
        fields[-1] = 0
    else:  # One of the materials is rare.
        fields = rng.random((m + 1, *places)) ** 3
    fields *= (rng.random(m + 1) + 0.05).reshape(-1, *(1,) * dim)
    fields /= np.maximum(fields.sum(axis=0), 1e-9)
    names = [f"material {k}" for k in range(m)]
    grid = BackgroundGrid(shape=shape, cell_size=1.0, origin=(0.0,) * dim)
    multiples = [np.floor(f * FULL).astype(np.int32) for f in fields[:m]]
    fractions = MaterialFractions.from_multiples(grid, names, multiples)
    thresholds = dict(zip(fractions.names, (rng.random(m + 1) * 0.8 + 0.2).tolist(), strict=True))
    return fractions, thresholds
