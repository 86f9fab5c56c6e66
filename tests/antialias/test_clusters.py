import numpy as np
import pytest
from fields import make_fractions

from tusqh.antialias.clusters import (
    CONNECT,
    SEPARATE,
    decide_by_fraction,
    decide_by_vote,
    label_clusters,
)

# Three pinches in a row vote connect, connect, separate; one far away votes connect.
PINCHES = np.zeros((6, 6), dtype=bool)
PINCHES[1, 1:4] = True
PINCHES[4, 4] = True
FRACTION = np.zeros((6, 6))
FRACTION[1, 1:4] = [0.5, 0.75, 0.25]
FRACTION[4, 4] = 0.5


@pytest.mark.parametrize(
    ("policy", "expected"), [("separate", SEPARATE), ("connect", CONNECT), ("majority", CONNECT)]
)
def test_a_mixed_cluster_follows_the_policy_and_is_reported(policy, expected):
    decided = decide_by_vote(PINCHES, FRACTION >= 0.5, mixed_pinches=policy)
    assert (decided.at_vertex[1, 1:4] == expected).all()
    assert decided.at_vertex[4, 4] == CONNECT
    assert (decided.n_clusters, decided.clusters_overruled, decided.n_pinches) == (2, 1, 4)
    assert decided.pinches_overruled == (1 if expected == CONNECT else 2)


def test_a_fraction_equal_to_the_threshold_connects():
    values = make_fractions(np.eye(2), np.full((3, 3), 0.5)).values
    kept = np.eye(2, dtype=bool)
    assert decide_by_fraction(kept, values, threshold=0.5).at_vertex[1, 1] == CONNECT
    above = np.nextafter(0.5, 1)
    assert decide_by_fraction(kept, values, threshold=above).at_vertex[1, 1] == SEPARATE


def test_an_even_split_separates_by_majority():
    pair = np.zeros((3, 4), dtype=bool)
    pair[1, 1:3] = True
    votes = np.zeros((3, 4), dtype=bool)
    votes[1, 1] = True
    decided = decide_by_vote(pair, votes, mixed_pinches="majority")
    assert (decided.at_vertex[1, 1:3] == SEPARATE).all()


@pytest.mark.parametrize(("edge", "policy"), [(0.25, "majority"), (0.75, "majority")])
def test_in_space_the_edge_of_a_pinch_votes_with_its_ends(edge, policy):
    """Two diagonal cells share an edge, whose ends are also pinches and vote differently."""
    kept = np.zeros((2, 2, 1), dtype=bool)
    kept[0, 0] = kept[1, 1] = True
    values = np.zeros((5, 5, 3))
    values[2, 2] = [0.75, edge, 0.25]
    decided = decide_by_fraction(kept, values, threshold=0.5, mixed_pinches=policy)
    expected = CONNECT if edge > 0.5 else SEPARATE
    assert decided.at_vertex[1, 1].tolist() == [expected, expected]
    assert (decided.n_clusters, decided.pinches_overruled) == (1, 1)


def test_diagonal_pinches_are_no_cluster_in_the_plane_but_one_in_space():
    assert label_clusters(np.eye(3, dtype=bool))[1] == 3
    in_space = np.zeros((3, 3, 3), dtype=bool)
    in_space[0, 0, 0] = in_space[1, 1, 0] = True
    assert label_clusters(in_space)[1] == 1
    in_space[1, 1, 0], in_space[1, 1, 1] = False, True
    assert label_clusters(in_space)[1] == 2
