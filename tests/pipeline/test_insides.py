"""Meshes of surfaces without an inside: furniture of doubled sheets, open scans, and errors."""

import sys

import numpy as np
import pytest
from doubled_sheets import BOXES, doubled_sheets

import tusqh
from tusqh.cli.app import main
from tusqh.errors import ConfigError, SamplingError
from tusqh.geometry.soup import Soup
from tusqh.pipeline.ingest import read_source
from tusqh.pipeline.insides import compare_insides
from tusqh.sampling.fractions import sample_fractions
from tusqh.settings.arguments import from_options
from tusqh.settings.model import Settings
from tusqh.settings.sampling import Sampling

#: Open surfaces, and a ball in cells wider than their openings; None: an opening is a whole side.
OPEN = {
    "mannequin-devil.off": None,
    "elephant-with-holes.off": 3.0,
    "lion.off": None,
}


def area_of(points, triangles):
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


@pytest.mark.parametrize("name", BOXES)
def test_envelopes_of_doubled_sheets_have_the_volume_of_the_solids(name):
    points, triangles, volume = doubled_sheets(name)
    with pytest.raises(SamplingError, match="has no inside") as error:
        tusqh.mesh((points, triangles), cells=32)
    assert "--inside envelope" in str(error.value)
    assert "--inside shell --thickness" in str(error.value)
    result = tusqh.mesh((points, triangles), cells=32, inside="envelope")
    report = result.report
    assert (report.measured, report.is_met, report.is_suitable) == ((1, 0, 0), True, True)
    layer = 0.5 * result.fractions.grid.cell_size * area_of(points, triangles) / 2
    assert abs(result.mesh.measurement.volume - volume) < layer
    assert result.built.reference.volume == pytest.approx(volume, rel=0.03)
    one_sided = Soup(points, triangles[: len(triangles) // 2], np.zeros(len(triangles) // 2, int))
    wound = sample_fractions(one_sided, result.fractions.grid, sampling=Sampling(rule="clamped"))
    assert (result.fractions.multiples >= wound.multiples).all()
    # The ball leaves round corners in the angles between boxes.
    assert result.fractions.volume() == pytest.approx(wound.volume(), rel=0.01)
    shell = tusqh.mesh((points, triangles), cells=32, inside="shell")
    thickness = shell.fractions.grid.cell_size
    assert shell.report.is_suitable
    assert shell.mesh.measurement.volume == pytest.approx(
        thickness * area_of(points, triangles) / 2, rel=0.3
    )


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=pytest.mark.slow if OPEN[n] else ()) for n in OPEN],
)
def test_open_surfaces_get_shells_and_their_closed_ones_envelopes(name, repository):
    path = repository / "data_sources/zoo" / name
    shell = tusqh.mesh(path, cells=20, inside="shell")
    size, geometry = shell.fractions.grid.cell_size, shell.geometry
    area = area_of(geometry.points, geometry.triangles)
    assert shell.report.is_suitable
    assert abs(shell.mesh.measurement.volume - size * area) < 0.5 * size * area
    solid = tusqh.mesh(path, cells=20)
    joined = tusqh.mesh(path, cells=20, inside="union")
    assert joined.fractions.volume() > solid.fractions.volume()
    if OPEN[name] is None:
        return
    closed = tusqh.mesh(path, cells=20, inside="envelope", seal=f"{OPEN[name]} cells")
    layer = 0.5 * closed.fractions.grid.cell_size * area
    assert abs(closed.mesh.measurement.volume - solid.built.reference.volume) < layer


def test_the_table_of_insides_has_volumes_and_betti_numbers():
    points, triangles, volume = doubled_sheets("table")
    geometry = read_source((points, triangles), name="table", image={}).geometry
    table = compare_insides(geometry, Settings()).set_index("inside")
    assert table.loc["winding", "volume"] == 0
    assert "no inside" in table.loc["winding", "note"]
    assert table.loc["envelope", "volume"] == pytest.approx(volume, rel=0.08)
    assert table.loc["envelope", ["components", "holes", "voids"]].tolist() == [1, 0, 0]
    assert table.loc["shell", "volume"] == table.loc["union", "volume"] > 0


def test_inspect_shows_the_table_before_the_error(tmp_path, capfd, monkeypatch):
    lines = "x0,y0,x1,y1\n0,0,4,0\n4,0,4,4\n4,4,0,4\n0,4,0,0\n"
    back = "4,0,0,0\n4,4,4,0\n0,4,4,4\n0,0,0,4\n"
    (tmp_path / "sheets.csv").write_text(lines + back)
    monkeypatch.setattr("tusqh.cli.app.catch_signals", lambda: None)
    monkeypatch.setattr(sys, "argv", ["tusqh", "inspect", str(tmp_path / "sheets.csv")])
    with pytest.raises(SystemExit):
        main()
    out = capfd.readouterr().out
    rows = [line.split("│")[1:-1] for line in out.splitlines() if line.startswith("│ envelope")]
    assert [float(rows[0][1]), int(rows[0][2])] == [16.0, 1]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"seal": "1"}, "found 1.0 with `inside: winding`"),
        ({"seal": "1", "inside": "shell"}, "`inside: envelope` beside it"),
        ({"thickness": "1", "inside": "envelope"}, "`inside: shell` or `inside: union` beside it"),
        (
            {"seal": "wide", "inside": "envelope"},
            "a positive length, in the model's unit",
        ),
        ({"seal": "-1", "inside": "envelope"}, "option --seal"),
        ({"inside": "hull"}, "one of winding, envelope, shell, union"),
    ],
)
def test_contradictory_settings_are_refused(options, message):
    with pytest.raises(ConfigError, match=message):
        from_options(Settings, options)


def test_materials_may_be_envelopes():
    points, triangles, volume = doubled_sheets("plane")
    other = points + np.array([0, 0, 20])
    result = tusqh.mesh(
        {"a": (points, triangles), "b": (other, triangles)}, cell_size=0.3, inside="envelope"
    )
    volumes = result.fractions.volumes()
    assert volumes["a"] == pytest.approx(volume, rel=0.06)
    assert volumes["b"] == pytest.approx(volume, rel=0.06)
