"""The content of files, and the equality of two contents."""

import numpy as np
import pytest
from fields import noise_mesh
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from provenance.content import Content, Numbers, sketch
from provenance.equality import EqualityRules, is_numerically_equal
from provenance.plan import EQUALITY
from provenance.read_content import read_content
from tusqh.errors import ConfigError
from tusqh.meshes.export import write_vtu
from tusqh.meshes.formats import write_mesh
from tusqh.meshes.volume_mesh import VolumeMesh


def compare(one, other, tolerance=1e-9):
    return is_numerically_equal(read_content(one), read_content(other), tolerance)


@pytest.mark.parametrize(
    ("text", "tolerance"),
    [
        ("name,x,n\na,1.5,1\nb,2.5e3,2\n", 1e-9),
        ("name,x,n\nb,2500.0,2\na,1.50,1\n", 1e-9),
        ("name,x,n\na,1.5000000000001,1\nb,2.5e3,2\n", 1e-9),
        ("name,x,n\na,1.5000001,1\nb,2.5e3,2\n", 1e-6),
        ("name,x,n\na,1.50001,1\nb,2.5e3,2\n", None),
        ("name,x,n\na,1.5,2\nb,2.5e3,2\n", None),
        ("name,x,n\na,1.5,1\n", None),
        ("name,y,n\na,1.5,1\nb,2.5e3,2\n", None),
        ("name,x,n\na,nan,1\nb,2.5e3,2\n", None),
    ],
)
def test_tables(tmp_path, text, tolerance):
    """Two tables are equal within the tolerance, if any, and not within a smaller one."""
    (tmp_path / "a.csv").write_text("name,x,n\na,1.5,1\nb,2.5e3,2\n")
    (tmp_path / "b.csv").write_text(text)
    found = [t for t in (1e-9, 1e-6) if compare(tmp_path / "a.csv", tmp_path / "b.csv", t)]
    assert (found[0] if found else None) == tolerance


def test_rounding_errors_in_columns_of_errors_are_not_a_difference(tmp_path):
    for name, number in (("a", "1e-16"), ("b", "3e-16")):
        (tmp_path / f"{name}.csv").write_text(f"relative_error,x\n{number},1.0\n")
        (tmp_path / f"other_{name}.csv").write_text(f"x\n{number}\n")
    assert compare(tmp_path / "a.csv", tmp_path / "b.csv")
    assert not compare(tmp_path / "other_a.csv", tmp_path / "other_b.csv")


@pytest.fixture(params=[2, 3], ids=["quads", "hexes"])
def mesh(request):
    return noise_mesh((6, 5, 4)[: request.param])


def renumbered(mesh, rng, noise=0.0):
    order, cells = rng.permutation(len(mesh.points)), rng.permutation(mesh.n_cells)
    new_number = np.argsort(order)
    return VolumeMesh(
        points=mesh.points[order] * (1 + noise),
        cells=new_number[mesh.cells][cells],
        kind=mesh.kind[cells],
        grid_cell=mesh.grid_cell[cells],
        name=mesh.name,
    )


@pytest.mark.parametrize("suffix", [".vtu", ".msh", ".exo"])
def test_a_mesh_is_the_same_however_it_is_numbered(mesh, tmp_path, suffix):
    rng = np.random.default_rng(0)
    moved = mesh.points.copy()
    moved[3] += 0.01
    others = {
        "same": mesh,
        "renumbered": renumbered(mesh, rng),
        "noise": renumbered(mesh, rng, noise=1e-13),
        "moved": VolumeMesh(moved, mesh.cells, mesh.kind, mesh.grid_cell, mesh.name),
        "cut": VolumeMesh(
            mesh.points, mesh.cells[1:], mesh.kind[1:], mesh.grid_cell[1:], mesh.name
        ),
    }
    write = write_vtu if suffix == ".vtu" else write_mesh
    for name, other in others.items():
        write(tmp_path / f"{name}{suffix}", other)
    equal = {n for n in others if compare(tmp_path / f"same{suffix}", tmp_path / f"{n}{suffix}")}
    assert equal == {"same", "renumbered", "noise"}


def test_arrays_do_not_depend_on_their_compression(tmp_path):
    values = np.arange(1000)
    np.savez(tmp_path / "a.npz", values=values)
    np.savez_compressed(tmp_path / "b.npz", values=values)
    values[500] += 1
    np.savez(tmp_path / "c.npz", values=values)
    assert compare(tmp_path / "a.npz", tmp_path / "b.npz")
    assert not compare(tmp_path / "a.npz", tmp_path / "c.npz")


@given(
    arrays.arrays(np.float64, st.integers(0, 300), elements=st.floats(-1e3, 1e3)),
    st.integers(0, 299),
    st.floats(1e-3, 1),
)
def test_one_changed_number_changes_the_sketch_by_as_much(numbers, index, change):
    if index >= len(numbers):
        return
    other = numbers.copy()
    other[index] += change
    difference = np.abs(sketch(other) - sketch(numbers))
    assert difference.max() >= change * (1 - 1e-6)
    assert Numbers.of(numbers).difference(Numbers.of(numbers.copy())) == 0
    assert Numbers.of(numbers).difference(Numbers.of(other)) > 0


def test_contents_survive_the_lock(tmp_path):
    (tmp_path / "a.csv").write_text("x,y\n1.5,inf\n0.1,nan\n" + "0.25,1\n" * 30)
    content = read_content(tmp_path / "a.csv")
    assert Content.from_dict(content.to_dict()).difference(content)[0] < 1e-11


@pytest.mark.parametrize(
    ("path", "equality", "tolerance"),
    [
        ("results/bay/curves.csv", "exact", 0),
        ("results/bay/diagram.csv", "numeric", 1e-9),
        ("results/bay/simulation/concentration_00001.vtu", "numeric", 1e-6),
        ("results/bay/sweep/0.5.vtu", "numeric", 1e-9),
        ("results/figures/pinches.png", "unchecked", 0),
        ("results/tables/peers_timing.csv", "unchecked", 0),
        ("results/bunny/peers/pytetwild.csv", "unchecked", 0),
        ("results/bunny/peers/tusqh.csv", "exact", 0),
        ("results/tables/peers_summary.csv", "unchecked", 0),
        ("results/page/results.md", "unchecked", 0),
        ("results/workflow/Snakefile", "unchecked", 0),
    ],
)
def test_every_output_has_its_class(repository, path, equality, tolerance):
    rule = EqualityRules.from_file(repository / EQUALITY).of(path)
    assert (rule.equality, rule.tolerance) == (equality, tolerance)


@pytest.mark.parametrize(
    "text", ["- {pattern: a}", "- {pattern: a, equality: same}", "a: 1", "- 1", "["]
)
def test_broken_rules_are_explained(tmp_path, text):
    (tmp_path / "equality.yaml").write_text(text)
    with pytest.raises(ConfigError, match=r"equality\.yaml"):
        EqualityRules.from_file(tmp_path / "equality.yaml")
