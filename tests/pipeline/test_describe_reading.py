"""The description of what was read: units and their origin, counts, boxes, closed or open."""

import json

import ezdxf
import numpy as np
import pytest
import tifffile
import trimesh

from tusqh.hashing import canonical_json
from tusqh.pipeline.describe_reading import describe_reading, lines_of_reading
from tusqh.pipeline.ingest import read_source


def facts_of(path):
    """Return the facts as they come back from a file."""
    facts = describe_reading(read_source(path))
    stored = json.loads(canonical_json(facts))
    assert lines_of_reading(stored) == lines_of_reading(facts)
    return stored


@pytest.mark.parametrize("code", [(0, None), (1, "in"), (4, "mm"), (6, "m")])
def test_the_unit_of_a_dxf_is_the_one_in_its_header(tmp_path, code):
    drawing = ezdxf.new("R2000")
    drawing.header["$INSUNITS"] = code[0]
    drawing.modelspace().add_circle((0, 0), 2)
    drawing.saveas(tmp_path / "a.dxf")
    facts = facts_of(tmp_path / "a.dxf")
    assert facts["unit"] == {"name": code[1], "source": "file" if code[1] else "none"}
    assert np.allclose(facts["box"], [[-2, -2], [2, 2]], atol=1e-3)
    assert facts["closed"] is True


def test_a_dxf_without_a_header_has_no_unit(tmp_path):
    text = "0 SECTION 2 ENTITIES 0 CIRCLE 8 0 10 0 20 0 40 1 0 ENDSEC 0 EOF"
    (tmp_path / "a.dxf").write_text("\n".join(text.split()) + "\n")
    assert facts_of(tmp_path / "a.dxf")["unit"] == {"name": None, "source": "none"}


def test_glb_is_in_metres_by_its_format(tmp_path):
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "a.glb")
    facts = facts_of(tmp_path / "a.glb")
    assert facts["unit"] == {"name": "m", "source": "format"}
    assert facts["counts"] == {"parts": 1, "triangles": 12, "points": 8, "boundary_edges": 0}


def test_imagej_gives_the_unit_of_a_stack(tmp_path):
    voxels = np.zeros((4, 5, 6), dtype=np.uint8)
    voxels[1, 2, 3] = 255
    metadata = {"axes": "ZYX", "spacing": 0.5, "unit": "mm"}
    tifffile.imwrite(tmp_path / "a.tif", voxels, imagej=True, resolution=(2, 2), metadata=metadata)
    facts = facts_of(tmp_path / "a.tif")
    assert facts["unit"] == {"name": "mm", "source": "file"}
    assert facts["box"] == [[0, 0, 0], [3, 2.5, 2]]
    assert facts["closed"] is None
    assert facts["counts"] == {"voxels_x": 6, "voxels_y": 5, "voxels_z": 4}


def test_a_box_without_a_lid_is_open(tmp_path):
    box = trimesh.creation.box((1, 1, 1))
    box.update_faces(np.arange(12) > 1)
    box.export(tmp_path / "a.stl")
    facts = facts_of(tmp_path / "a.stl")
    assert facts["closed"] is False
    assert facts["counts"]["boundary_edges"] == 4
    assert "open (4 boundary edges)" in lines_of_reading(facts)["read"]
