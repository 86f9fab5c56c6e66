"""Components of graphs and of touching cells, beside scipy's."""

import numpy as np
import pytest
from scipy import ndimage
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tusqh.grid.components import count_touching_cells, label_components


@pytest.mark.parametrize("seed", range(40))
def test_labels_are_those_of_scipy(seed):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 60))
    first, second = rng.integers(0, n, (2, int(rng.integers(0, 2 * n))))
    graph = coo_array((np.ones(len(first)), (first, second)), shape=(n, n))
    n_expected, expected = connected_components(graph, directed=False)
    labels, n_components = label_components(first, second.astype(np.int32), n)
    assert n_components == n_expected
    np.testing.assert_array_equal(labels, expected)


def test_a_graph_without_nodes_has_no_component():
    none = np.empty(0, dtype=np.int64)
    labels, n_components = label_components(none, none, 0)
    assert n_components == len(labels) == 0


@pytest.mark.parametrize("shape", [(9, 7), (6, 5, 7), (1, 1, 1)])
@pytest.mark.parametrize("seed", range(10))
def test_touching_cells_are_counted_as_by_scipy(shape, seed):
    rng = np.random.default_rng(seed)
    kept = rng.random(shape) < rng.uniform(0.02, 0.4)
    labels, n = ndimage.label(kept, np.ones((3,) * len(shape)))
    expected = np.bincount(labels.ravel(), minlength=n + 1)[1:]
    assert sorted(count_touching_cells(kept).tolist()) == sorted(expected.tolist())
