"""Read the surface of a VTK, VTU or VTP file; of a volume mesh its boundary."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pyvista
from vtkmodules.vtkCommonCore import vtkLogger

from tusqh.geometry.soup import Soup
from tusqh.readers.logs import collect_logs
from tusqh.readers.polygon_faces import damaged
from tusqh.readers.reading import Reading
from tusqh.readers.surfaces import surfaces_of_dataset
from tusqh.readers.vtk_legacy import check_legacy

#: Bytes at the end of a file among which its last tag is.
_TAIL = 4096


def read(path: Path) -> Reading:
    """Read the surface as a soup of one part.

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
        The file is cut off or damaged, or the soup is empty, without extent or not finite.
    """
    if path.suffix.lower() == ".vtk":
        check_legacy(path)
    elif b"</VTKFile>" not in path.read_bytes()[-_TAIL:]:
        raise damaged(
            path, "the file ends before `</VTKFile>`", expected="a complete VTK file in XML"
        )
    with _quiet(), collect_logs("root"), pyvista.VtkErrorCatcher(send_to_logging=False) as catcher:
        dataset = pyvista.read(path)
    if catcher.error_events:
        found = str(catcher.error_events[0].alert).strip().splitlines()
        raise damaged(
            path,
            f"VTK reports: {found[-1] if found else 'an error'}",
            expected="a complete VTK file",
        )
    parts, remarks = surfaces_of_dataset(dataset, name=str(path))
    return Reading(Soup.from_parts(parts, name=path.name), tuple(remarks))


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep what VTK logs from standard error; the error that is raised says it."""
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    try:
        yield
    finally:
        vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_INFO)
