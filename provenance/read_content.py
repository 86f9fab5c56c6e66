"""Read the content of a file according to its suffix."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import numpy as np

from provenance.content import Content, content_of_arrays, content_of_table, content_of_text
from provenance.mesh_content import content_of_meshio, content_of_vtk

#: Digests and sizes of other files inside a file, which are ignored as those files are compared.
_OF_OTHER_FILES = re.compile(r'"(sha256|contentSize)": "?\w+"?')


def read_content(path: Path) -> Content | None:
    """Return the content of a file, or None for formats that are compared byte by byte.

    It omits the numbering of meshes, the order of the rows of tables, the compression of arrays and
    the digests of other files.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    OSError
        The file does not exist.
    """
    match path.suffix:
        case ".csv":
            with path.open(encoding="utf-8", newline="") as stream:
                return content_of_table(list(csv.reader(stream)))
        case ".md":
            lines = path.read_text("utf-8").splitlines()
            return content_of_table([line.split("|") for line in lines])
        case ".json":
            text = _OF_OTHER_FILES.sub(r'"\1": "#"', path.read_text("utf-8"))
            return content_of_text(text, is_scaled=False)
        case ".mesh" | ".inp" | ".pvd":
            return content_of_text(path.read_text("utf-8"), is_scaled=True)
        case ".npz":
            with np.load(path) as file:
                return content_of_arrays({name: file[name] for name in file.files})
        case ".vtu" | ".vtp":
            return content_of_vtk(path)
        case ".msh" | ".exo":
            return content_of_meshio(path)
        case _:
            return None
