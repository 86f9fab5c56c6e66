"""The catalogue of pinches, pinches in series, connecting edges, and the aliasing examples."""

import itertools

import numpy as np
from oracles import gudhi_betti

from studies.aliasing import compare_examples, sweep_axis_gap
from studies.methods.digital_topology import closed_betti
from studies.methods.raw_mesh import raw_mesh
from studies.pinch_catalogue import (
    connect_edges,
    list_configurations,
    resolve_series,
    tabulate_catalogue,
)
from tusqh.antialias.pinches import pinch_table


def test_the_configurations_are_the_orbits_of_the_cubes_symmetries():
    """Burnside's lemma: the number of orbits is the mean number of configurations kept fixed."""
    for dim, expected in ((2, 1), (3, 11)):
        fields = [
            np.array([code >> b & 1 for b in range(2**dim)]).reshape((2,) * dim)
            for code in np.flatnonzero(pinch_table(dim))
        ]
        symmetries = [
            (axes, flip)
            for axes in itertools.permutations(range(dim))
            for flip in itertools.product((slice(None), slice(None, None, -1)), repeat=dim)
        ]
        fixed = sum(
            np.array_equal(field, field.transpose(axes)[flip])
            for axes, flip in symmetries
            for field in fields
        )
        assert fixed == expected * len(symmetries)
        assert len(list_configurations(dim)) == expected


def test_every_pinch_is_resolved_both_ways_and_sound():
    facts, elements = tabulate_catalogue()
    raw, resolved = facts[facts["stage"] == "raw"], facts[facts["stage"] != "raw"]
    assert len(raw) == 12
    assert not raw["sound"].any()
    assert resolved["sound"].all()
    assert resolved["as_predicted"].all()
    assert (resolved["overruled"] == 0).all()
    assert len(elements) == facts["elements"].sum()
    in_space = raw[raw["dimension"] == 3]
    assert sorted(in_space["pinch_edges"]) == [0, 0, 1, 1, 1, 1, 2, 2, 3, 3, 6]


def test_raw_topology_against_gudhi():
    for kept in list_configurations(3):
        assert gudhi_betti(raw_mesh(kept).cells) == closed_betti(kept)


def test_every_pinch_in_series_follows_its_own_vote():
    facts = resolve_series()[0].set_index("panel")
    assert facts["joined_contacts"].equals(facts["votes_to_connect"])
    n = facts.loc["raw", "contacts"]
    assert facts.loc["one staircase each way", "joined_contacts"] == n / 2
    assert 0 < facts.loc["alternating", "joined_contacts"] < n
    meshes = facts.drop(index="raw")
    assert meshes["sound"].all()
    assert meshes["as_predicted"].all()


def test_edges_connect_one_more_block_at_every_lower_threshold():
    facts, _ = connect_edges()
    assert facts["components"].tolist() == [4, 3, 2, 1]
    assert facts["bridges"].tolist() == [0, 1, 2, 1]
    assert facts["raw_components"].tolist() == [4, 4, 4, 2]
    assert facts["sound"].all()
    assert facts["as_predicted"].all()


def test_antialiasing_opens_the_gap_and_joins_the_wedge():
    shapes, facts = compare_examples()
    facts = facts.set_index("example")
    gap, wedge = facts.loc["diagonal gap"], facts.loc["wedge"]
    assert gap["contacts"] > 0
    assert (gap["components_before"], gap["components"], gap["holes"]) == (1, 2, 0)
    assert wedge["components_before"] > 1
    assert (wedge["components"], wedge["removed_components"]) == (1, 0)
    assert facts["sound"].all()
    assert set(shapes["panel"]) == {f"{e}: {s}" for e in facts.index for s in ("before", "after")}


def test_axis_gaps_of_real_meshes_open_as_the_closed_form_says():
    """A gap is open if its best column is more than half empty; length and overlap are by hand."""
    table = sweep_axis_gap(24)
    rows = table[table["scheme"] == "filtration"]
    for width in (0.4, 0.75, 1.2):
        away = np.abs(rows["offset"] - np.rint(rows["offset"]))
        overlap = np.minimum(width, np.minimum(1, (1 + width) / 2 - away))
        assert ((rows[f"components_{width:g}"] == 2) == (overlap > 0.5 + 1e-9)).all()
        assert ((rows["opening"] < width - 1e-9) == (overlap > 0.5 + 1e-9)).all()
