"""`tusqh background`: makers, and a mesh on one of their backgrounds."""

import numpy as np
import pytest
import trimesh
from typer.testing import CliRunner

from tusqh.background.reading import read_background
from tusqh.cli.app import app
from tusqh.errors import ConfigError, MeshError, TusqhError
from tusqh.meshes.export import read_vtu

BOX = ["--lower", "0,0,0", "--upper", "2,2,2", "--cells", "8,8,8"]


def run(*words):
    done = CliRunner().invoke(app, ["background", *map(str, words)])
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        raise done.exception
    return done


@pytest.mark.parametrize(
    ("words", "n_cells"),
    [
        (["box", *BOX], 512),
        (["layers", *BOX, "--growth", "1.3"], 512),
        (["cylinder", "--radius", "1", "--height", "2"], 1056),
        (["cylinder", "--radius", "1", "--unit", "mm"], 132),
    ],
)
def test_makers_write_what_is_read_back(tmp_path, words, n_cells):
    path = tmp_path / "background.vtu"
    assert f"{n_cells:,} cells" in run(*words, "-o", path).output
    assert read_background(path).n_cells == n_cells


def test_a_ball_on_an_o_grid_is_meshed_and_wrong_options_are_explained(tmp_path):
    background, ball, out = tmp_path / "c.vtu", tmp_path / "ball.stl", tmp_path / "mesh.vtu"
    run("cylinder", "--radius", 1.3, "--height", 2.6, "--centre", "0,0,-1.3", "-o", background)
    trimesh.creation.icosphere(subdivisions=2).export(ball)
    done = run("mesh", ball, background, "--betti", "1,0,0", "-o", out)
    assert "Betti numbers (1, 0, 0) as predicted" in done.output
    found = read_vtu(out)
    assert found.measurement.is_sound
    assert np.isfinite(found.points).all()
    for words, error in (
        (["--betti", "1,x,0"], ConfigError),
        (["--samples", "3"], ConfigError),
        (["--threshold", "2"], ConfigError),
        (["--threshold", "0.5", "--betti", "1,0,0"], ConfigError),
    ):
        with pytest.raises(error):
            run("mesh", ball, background, *words, "-o", out)
    with pytest.raises(MeshError, match="no such file"):
        run("mesh", ball, tmp_path / "none.vtu", "-o", out)
    with pytest.raises(TusqhError):
        run("box", "--lower", "0,0", "--upper", "1,a", "--cells", "2,2", "-o", out)
    with pytest.raises(ConfigError):
        run("box", "--lower", "0,0", "--upper", "1,1", "--cells", "2,2.5", "-o", out)
