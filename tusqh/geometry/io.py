"""The canonical outline file: a VTP that ParaView opens, bit-exact and the same every time."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from tusqh.atomic import replacing
from tusqh.errors import GeometryError
from tusqh.geometry.outline import Outline

_SUFFIX = ".vtp"


def write_outline(path: Path, outline: Outline) -> None:
    """Write an outline as a binary VTP: segments as line cells, cell data ``chain``.

    The file appears whole or not at all: it is written under a temporary name in the same
    folder and then renamed.  Equal outlines give equal bytes.

    Raises
    ------
    GeometryError
        The name does not end in ``.vtp``.
    """
    import pyvista

    _check_suffix(path)
    n_points, n_segments = len(outline.points), outline.n_segments
    mesh = pyvista.PolyData(
        np.column_stack([outline.points, np.zeros(n_points)]),
        lines=np.column_stack([np.full(n_segments, 2), outline.segments]).ravel(),
    )
    mesh.cell_data["chain"] = outline.chains
    mesh.field_data["name"] = [json.dumps(outline.name)]  # VTK strings are ASCII
    with replacing(path) as temporary:
        mesh.save(temporary, binary=True)


def load_outline(path: Path) -> Outline:
    """Return the outline that `write_outline` wrote, equal in every bit.

    Raises
    ------
    GeometryError
        The file is missing or is not an outline file.
    """
    import pyvista

    _check_suffix(path)
    if not path.is_file():
        raise GeometryError(
            "there is no such file",
            where=str(path),
            expected="an outline file",
            remedy="run the step that makes it, `ingest`",
        )
    try:
        mesh = pyvista.read(path)
        points = np.array(mesh.points[:, :2], dtype=np.float64)
        segments = np.array(mesh.lines, dtype=np.int64).reshape(-1, 3)[:, 1:]
        chains = np.array(mesh.cell_data["chain"], dtype=np.int64)
        name = str(json.loads(str(mesh.field_data["name"][0])))
    except (KeyError, ValueError, AttributeError, IndexError, OSError, RuntimeError) as error:
        raise GeometryError(
            f"the file is not an outline: {error}",
            where=str(path),
            expected="line cells with cell data `chain` and a `name`, as `write_outline` makes it",
            remedy="remove the file and run the step that makes it again",
        ) from error
    return Outline(points=points, segments=segments.copy(), chains=chains, name=name)


def _check_suffix(path: Path) -> None:
    if path.suffix != _SUFFIX:
        raise GeometryError(
            f"the name ends in {path.suffix or 'nothing'!r}",
            where=str(path),
            expected=f"a name that ends in {_SUFFIX}",
            remedy=f"call the file {path.stem}{_SUFFIX}",
        )
