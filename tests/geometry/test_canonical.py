import numpy as np
import pytest
import pyvista

from tusqh.errors import GeometryError, OutputError
from tusqh.geometry.canonical import load_geometry, write_geometry
from tusqh.geometry.outline import Outline


def random_outline() -> Outline:
    rng = np.random.default_rng(7)
    return Outline(
        points=np.concatenate([rng.normal(size=(50, 2)) * 1e6, [[-0.0, 5e-324], [0.1, 1 / 3]]]),
        segments=rng.integers(0, 52, (80, 2)),
        chains=np.sort(rng.integers(0, 9, 80)),
        name="bay of Ærø.geojson",
    )


def test_round_trip_is_exact_in_every_bit(tmp_path):
    outline = random_outline()
    write_geometry(tmp_path / "a.vtp", outline)
    loaded = load_geometry(tmp_path / "a.vtp")
    assert loaded.points.tobytes() == outline.points.tobytes()
    assert loaded.segments.tobytes() == outline.segments.astype(np.int64).tobytes()
    assert loaded.chains.tobytes() == outline.chains.astype(np.int64).tobytes()
    assert loaded.name == outline.name


def test_bytes_are_the_same_every_time_and_nothing_else_is_left(tmp_path):
    for name in ("a.vtp", "b.vtp", "a.vtp"):
        write_geometry(tmp_path / name, random_outline())
    assert (tmp_path / "a.vtp").read_bytes() == (tmp_path / "b.vtp").read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.vtp", "b.vtp"]


def test_other_programs_see_line_cells(tmp_path):
    write_geometry(tmp_path / "a.vtp", random_outline())
    mesh = pyvista.read(tmp_path / "a.vtp")
    assert mesh.n_cells == mesh.n_lines == 80
    assert mesh.points.dtype == np.float64
    assert set(mesh.cell_data) == {"chain"}


def test_failed_write_leaves_the_old_file(tmp_path, monkeypatch):
    write_geometry(tmp_path / "a.vtp", random_outline())
    before = (tmp_path / "a.vtp").read_bytes()

    def fail(self, filename, **options):
        raise OSError("disk full")

    monkeypatch.setattr(pyvista.PolyData, "save", fail)
    with pytest.raises(OutputError, match="disk full"):
        write_geometry(tmp_path / "a.vtp", random_outline())
    assert (tmp_path / "a.vtp").read_bytes() == before
    assert len(list(tmp_path.iterdir())) == 1


def test_missing_outline(tmp_path):
    with pytest.raises(GeometryError, match="no such file"):
        load_geometry(tmp_path / "gone.vtp")


@pytest.mark.filterwarnings("ignore")
def test_corrupt_outline(tmp_path):
    (tmp_path / "a.vtp").write_text("rubbish")
    with pytest.raises(GeometryError, match="not a canonical geometry file"):
        load_geometry(tmp_path / "a.vtp")


def test_some_other_mesh_is_not_an_outline(tmp_path):
    pyvista.Line().save(tmp_path / "a.vtp")
    with pytest.raises(GeometryError, match="not a canonical geometry file"):
        load_geometry(tmp_path / "a.vtp")


def test_wrong_suffix(tmp_path):
    with pytest.raises(GeometryError, match=r"'\.vtk'"):
        write_geometry(tmp_path / "a.vtk", random_outline())
