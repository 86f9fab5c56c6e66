"""Load datasets of VTK files after checking them, because VTK may crash on damaged files."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pyvista
from vtkmodules.vtkCommonCore import vtkLogger

from tusqh.readers.gate import require_memory
from tusqh.readers.logs import collect_logs
from tusqh.readers.polygon_faces import damaged
from tusqh.readers.vtk_legacy import check_legacy

#: Counts that a file in XML states, and the least number of bytes for each item.
_NUMBERS = re.compile(rb"\b(NumberOf\w+)\s*=\s*[\"']([^\"']*)[\"']")
_BYTES = {"NumberOfPoints": 12, "NumberOfCells": 16, "NumberOfPolys": 16, "NumberOfStrips": 16}
#: First and last number of points along each axis of an image.
_EXTENTS = re.compile(rb"\b(\w*Extent)\s*=\s*[\"']([^\"']*)[\"']")
#: Number of bytes at the end of a file that contain its last tag.
_TAIL = 4096
_EXPECTED = "a complete VTK file"


def load_dataset(path: Path) -> Any:
    """Return the dataset of a file as VTK reads it.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    pyvista.DataSet
        The dataset.

    Raises
    ------
    GeometryError
        The file is cut off or damaged, or its stated content does not fit in memory.
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
            path, f"VTK reports: {found[-1] if found else 'an error'}", expected=_EXPECTED
        )
    return dataset


def _check_xml(path: Path) -> None:
    """Raise an error if a file is cut off, or states counts that VTK cannot allocate."""
    content = path.read_bytes()
    if b"</VTKFile>" not in content[-_TAIL:]:
        raise damaged(path, "the file ends before `</VTKFile>`", expected=_EXPECTED)
    head = content.partition(b"<AppendedData")[0]
    for name, value in _EXTENTS.findall(head):
        ends = [int(word) for word in value.split() if re.fullmatch(rb"-?\d{1,9}", word)]
        lengths = [high - low + 1 for low, high in zip(ends[::2], ends[1::2], strict=False)]
        if len(ends) != 6 or len(value.split()) != 6 or min(lengths) < 0:
            shown = b"=".join((name, value[:40])).decode(errors="replace")
            raise damaged(path, f"it states {shown}", expected=_EXPECTED)
        require_memory(path, math.prod(lengths), what=f"an image of {lengths} points")
    for name, value in _NUMBERS.findall(head):
        if not re.fullmatch(rb"\s*\d{1,15}\s*", value):
            shown = b"=".join((name, value[:20])).decode(errors="replace")
            raise damaged(path, f"it states {shown}", expected=_EXPECTED)
        need = _BYTES.get(name.decode(), 1) * int(value)
        require_memory(path, need, what=f"{name.decode()}={int(value)}")


@contextmanager
def _quiet() -> Iterator[None]:
    """Suppress VTK's log on standard error, because the raised error contains the message."""
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    try:
        yield
    finally:
        vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_INFO)
