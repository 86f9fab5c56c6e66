"""On random fields with ties, the result has the seed's Betti numbers by three counts."""

import itertools

import numpy as np
import pytest
from flag_complexes import betti_by_flag_complex, has_contractible_link

from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import build_mesh
from tusqh.antialias.scheme import PINCH_TEMPLATES
from tusqh.grid import BackgroundGrid
from tusqh.local_topology.move import move_to_base
from tusqh.sampling.fractions import VolumeFractions, round_fractions
from tusqh.settings.goal import Goal, Target
from tusqh.settings.policy import Policy
from tusqh.threshold.choose import choose_threshold
from tusqh.threshold.plateaus import BETTI, Plateaus, merge_intervals

NO_BRIDGES = Policy(bridges="none")


def random_field(seed, dim, largest):
    """Return fractions with ties and plateaus, smooth or rough, whose sub-cells may contradict."""
    rng = np.random.default_rng(seed)
    shape = tuple(int(n) for n in rng.integers(2, largest + 1, dim))
    places = tuple(2 * n + 1 for n in shape)
    kind = seed % 4
    if kind == 0:
        values = rng.random(places)
    elif kind == 1:
        values = rng.integers(0, 4, places) / 3
    elif kind == 2:  # Few levels with some noise.
        values = np.clip(rng.integers(0, 6, places) / 5 + 0.2 * (rng.random(places) - 0.5), 0, 1)
    else:  # The inside is nearly full.
        values = np.clip(rng.random(places) + 0.3, 0, 1)
    grid = BackgroundGrid(shape=shape, cell_size=1.0, origin=(0.0,) * dim)
    return VolumeFractions.from_values(grid, 4, round_fractions(values))


def some_thresholds(cell_sets, rng, n):
    """Return the thresholds of some plateaus, of all if there are at most n."""
    levels = cell_sets.distinct_fractions
    return [float(t) for t in (levels if len(levels) <= n else rng.choice(levels, n, False))]


def require_topology(found, seed):
    """Check the Betti numbers of a result by prediction, mesh and flag complex."""
    assert found.predicted == seed.predicted
    mesh = build_mesh(found, found.fractions.grid).mesh
    if found.kept.any():
        assert mesh.measurement.has_topology(seed.predicted)
        assert mesh.measurement.is_sound
        assert mesh.measurement.is_manifold
        assert PINCH_TEMPLATES.allows(mesh.measurement.smallest_scaled_jacobian, mesh)
    votes = found.fractions.values >= seed.threshold
    assert betti_by_flag_complex(found.kept, votes) == tuple(seed.predicted)
    assert mesh.dim == 2 or found.n_overruled == 0


def require_no_simple_cell(found, seed):
    """Check that every cell that differs from the base changes the topology."""
    votes = found.fractions.values >= seed.threshold
    for cell in np.argwhere(found.kept != found.in_base).tolist():
        assert not has_contractible_link(found.kept, votes, cell), cell


def every_interval(cell_sets):
    """Return a threshold of every interval with the same Betti numbers."""
    return merge_intervals(Plateaus(cell_sets).table)["threshold"].tolist()


def check_field(seed, dim, largest, n_seeds=None):
    """Check results of a random field, by default of every interval as the seed.

    Returns
    -------
    n_seeds, n_changed
        The numbers of seeds and of cells that were changed.
    """
    fractions, rng = random_field(seed, dim, largest), np.random.default_rng(seed)
    cell_sets = CellSets(fractions, NO_BRIDGES)
    n_changed = 0
    if n_seeds is None:
        thresholds = every_interval(cell_sets)
    else:
        thresholds = some_thresholds(cell_sets, rng, n_seeds)
    for threshold in thresholds:
        start = cell_sets.at(threshold)
        base = cell_sets.at(float(rng.choice([0.5, rng.choice(cell_sets.distinct_fractions)])))
        found = move_to_base(start, base)
        require_topology(found, start)
        require_no_simple_cell(found, start)
        is_common = start.kept == base.kept
        assert (found.kept[is_common] == base.kept[is_common]).all()
        assert found.n_changes == found.changes["cells"].sum()
        n_changed += int((found.kept != start.kept).sum())
    return len(thresholds), n_changed


@pytest.mark.parametrize(("dim", "largest", "n_fields"), [(2, 7, 25), (3, 4, 10)])
def test_the_result_has_the_topology_of_its_seed(dim, largest, n_fields):
    assert sum(check_field(seed, dim, largest, 3)[1] for seed in range(n_fields)) > 100


@pytest.mark.slow
@pytest.mark.parametrize(("dim", "largest", "n_fields"), [(2, 6, 2000), (3, 3, 1200)])
def test_every_interval_of_many_fields_is_a_seed(dim, largest, n_fields):
    counts = [check_field(seed, dim, largest) for seed in range(1000, 1000 + n_fields)]
    n_seeds, n_changed = np.sum(counts, axis=0)
    assert n_seeds > 3 * n_fields
    assert n_changed > n_seeds


@pytest.mark.parametrize("dim", [2, 3])
def test_turned_and_mirrored_fields_have_turned_and_mirrored_results(dim):
    """Cells with different fractions have one order; of equal ones the first in the array wins."""
    n_changed = 0
    for seed in range(2 if dim == 3 else 6):
        rng = np.random.default_rng(seed)
        shape = tuple(int(n) for n in rng.integers(3, 6, dim))
        values = rng.random(tuple(2 * n + 1 for n in shape))
        is_cell = (slice(1, None, 2),) * dim
        n_cells = int(np.prod(shape))
        values[is_cell] = (rng.permutation(n_cells).reshape(shape) + 1) / (n_cells + 1)
        kept = moved_kept(values, 0.75, 0.35)
        for axes in itertools.permutations(range(dim)):
            for flips in itertools.product((1, -1), repeat=dim):
                turn = tuple(slice(None, None, step) for step in flips)
                turned = moved_kept(values.transpose(axes)[turn], 0.75, 0.35)
                assert np.array_equal(turned, kept.transpose(axes)[turn])
        n_changed += int((kept != (values[is_cell] >= 0.75)).sum())
    assert n_changed > 30


def moved_kept(values, threshold, base):
    """Return the kept cells of a threshold after the move to a base."""
    shape = tuple(n // 2 for n in values.shape)
    grid = BackgroundGrid(shape=shape, cell_size=1.0, origin=(0.0,) * len(shape))
    cell_sets = CellSets(VolumeFractions.from_values(grid, 4, round_fractions(values)), NO_BRIDGES)
    return move_to_base(cell_sets.at(threshold), cell_sets.at(base)).kept


def test_bridges_stay():
    n_bridges = 0
    for seed in range(40):
        fractions, rng = random_field(seed, 2, 10), np.random.default_rng(seed)
        cell_sets = CellSets(fractions)
        for threshold in some_thresholds(cell_sets, rng, 3):
            start = cell_sets.at(threshold)
            found = move_to_base(start, cell_sets.at(0.5))
            assert found.predicted == start.predicted
            if found.kept.any():
                measured = build_mesh(found, fractions.grid).mesh.measurement
                assert measured.has_topology(start.predicted)
                assert measured.is_sound
            n_bridges += found.n_bridges
    assert n_bridges > 20


@pytest.mark.parametrize("dim", [2, 3])
def test_the_flag_complex_is_that_of_the_mesh(dim):
    for seed in range(6):
        fractions = random_field(seed, dim, 4 if dim == 3 else 6)
        cells = CellSets(fractions, NO_BRIDGES).at(0.5)
        votes = fractions.values >= 0.5
        assert betti_by_flag_complex(cells.kept, votes) == tuple(cells.predicted)


@pytest.mark.parametrize("seed", range(4))
def test_every_reachable_target_is_met_from_every_base(seed):
    plateaus = Plateaus(CellSets(random_field(seed, 2 + seed % 2, 6 - 2 * (seed % 2))))
    wanted = plateaus.table[plateaus.table["cells"] > 0][BETTI].drop_duplicates()
    for row in wanted.head(5).to_dict("records"):
        for base in (0.25, 0.5, "match"):
            chosen, _ = choose_threshold(plateaus, Goal(target=Target(**row), base=base))
            assert chosen.predicted._asdict() == row
            assert chosen.resolved.mesh.measurement.by_boundary._asdict() == row
            at_base = plateaus.cell_sets.at(chosen.base)
            if at_base.predicted == chosen.predicted and at_base.kept.any():
                assert np.array_equal(chosen.cells.kept, at_base.kept)
