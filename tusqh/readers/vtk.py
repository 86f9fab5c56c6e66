"""Read the surface of a VTK, VTU or VTP file; of a volume mesh its boundary."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pyvista
from vtkmodules.vtkCommonCore import vtkLogger

from tusqh.geometry.soup import Soup
from tusqh.readers.gate import require_memory
from tusqh.readers.logs import collect_logs
from tusqh.readers.polygon_faces import damaged
from tusqh.readers.reading import Reading
from tusqh.readers.surfaces import surfaces_of_dataset
from tusqh.readers.vtk_legacy import check_legacy

#: Numbers of things that a file in XML states, and bytes that each takes at least.
_NUMBERS = re.compile(rb"\b(NumberOf\w+)\s*=\s*[\"']([^\"']*)[\"']")
_BYTES = {"NumberOfPoints": 12, "NumberOfCells": 16, "NumberOfPolys": 16, "NumberOfStrips": 16}
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
    else:
        _check_xml(path)
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


def _check_xml(path: Path) -> None:
    """Raise where a file is cut off, or has numbers of things that VTK cannot allocate."""
    content = path.read_bytes()
    expected = "a complete VTK file in XML"
    if b"</VTKFile>" not in content[-_TAIL:]:
        raise damaged(path, "the file ends before `</VTKFile>`", expected=expected)
    for name, value in _NUMBERS.findall(content.partition(b"<AppendedData")[0]):
        if not re.fullmatch(rb"\s*\d{1,15}\s*", value):
            shown = b"=".join((name, value[:20])).decode(errors="replace")
            raise damaged(path, f"it states {shown}", expected=expected)
        need = _BYTES.get(name.decode(), 1) * int(value)
        require_memory(path, need, what=f"{name.decode()}={int(value)}")


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep what VTK logs from standard error; the error that is raised says it."""
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    try:
        yield
    finally:
        vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_INFO)
