"""Read the solids of a STEP or IGES file, as triangles close to their surfaces.

Open CASCADE, by the library cascadio, makes the triangles in a process of its own, because it may
crash on a damaged file.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from tusqh.errors import GeometryError
from tusqh.extras import require
from tusqh.geometry.remark import Remark
from tusqh.geometry.units import METRES, metres_in, scaled, unit_name
from tusqh.readers.gltf import read_scene
from tusqh.readers.gltf_file import GltfFile
from tusqh.readers.polygon_faces import damaged
from tusqh.readers.reading import Reading

#: Largest distance of a triangle from its surface, relative to the edges of a face; and the largest
#: angle between neighbours, in radians.
_DISTANCE, _ANGLE = 1e-3, 0.2
_CODE = """
import sys, cascadio
source, target, kind, distance, angle = sys.argv[1:]
content = open(source, "rb").read()
glb = cascadio.load(content, kind, float(distance), float(angle), True, use_parallel=False)
open(target, "wb").write(glb)
"""
_PREFIXES = {"$": "m", ".MILLI.": "mm", ".CENTI.": "cm", ".DECI.": "dm", ".KILO.": "km"}
_PREFIXES |= {".MICRO.": "um", ".NANO.": "nm"}


def read(path: Path) -> Reading:
    """Read every solid and shell as a part, in the unit of length that the file states.

    Coordinates have single precision, and curved faces are within a thousandth of the length of
    their edges.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    Reading
        The geometry.

    Raises
    ------
    GeometryError
        The file is damaged or has no solid and no face.
    """
    require("cascadio", extra="cad")
    is_step = path.suffix.lower() in (".step", ".stp")
    kind = "step" if is_step else "iges"
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder, "shape.glb")
        words = [str(path), str(target), kind, str(_DISTANCE), str(_ANGLE)]
        done = subprocess.run(
            [sys.executable, "-c", _CODE, *words], capture_output=True, check=False
        )
        if done.returncode or not target.stat().st_size:
            lines = done.stderr.decode(errors="replace").strip().splitlines()
            reason = lines[-1][:120] if lines else f"it ended with {done.returncode}"
            raise damaged(
                path,
                f"Open CASCADE cannot read it: {reason}",
                expected=f"a complete {kind.upper()} file",
            )
        content = target.read_bytes()
    file = GltfFile(path, content)
    if not file.document.get("meshes"):
        raise GeometryError(
            "the file has no solid and no face",
            where=str(path),
            expected="at least one solid",
            remedy="export the parts as solids (AP 203, 214 or 242), not only their names, "
            "sketches or curves",
        )
    reading = read_scene(file, name=path.name)
    unit = _unit_of_step(path) if is_step else _unit_of_iges(path)
    what = "curved faces may be cut into triangles, within a thousandth of their edges"
    remarks = (*reading.remarks, Remark("changed", what, 1))
    made_in = "m" if is_step else "mm"  # The library converts STEP to metres, IGES to millimetres.
    unit = unit if metres_in(unit) else made_in
    factor = METRES[made_in] / METRES[unit]
    geometry = scaled(reading.geometry, factor, unit=unit)
    return replace(reading, geometry=geometry, unit=unit, remarks=remarks)


def _unit_of_step(path: Path) -> str:
    """Return the unit of length of a STEP file, empty if it is not found."""
    text = re.sub(r"\s+", " ", path.read_text("utf-8", errors="replace"))
    for entity in re.findall(r"#\d+ ?= ?\(([^;]*LENGTH_UNIT ?\( ?\)[^;]*)\) ?;", text):
        named = re.search(r"CONVERSION_BASED_UNIT ?\( ?'([^']*)'", entity)
        if named:
            return unit_name(named[1])
    found = re.findall(
        r"#\d+ ?= ?\(([^;]*LENGTH_UNIT ?\( ?\)[^;]*SI_UNIT ?\( ?(\$|\.\w+\.) ?, ?\.METRE\.[^;]*)",
        text,
    )
    return _PREFIXES.get(found[0][1], "") if found else ""


def _unit_of_iges(path: Path) -> str:
    """Return the unit of length in the global section of an IGES file, empty if it is not found."""
    rows = path.read_text("latin-1").splitlines()
    text = "".join(row[:72] for row in rows if len(row) > 72 and row[72] == "G")
    found = re.search(r",\d+,\d+H(INCH|IN|MM|FT|MI|M|KM|MIL|UM|CM)\b", text)
    return unit_name(found[1]) if found else ""
