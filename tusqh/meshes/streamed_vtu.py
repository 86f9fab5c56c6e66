"""Write one VTU file of hexes array by array, so that the mesh need not fit into memory.

The bytes are those that `tusqh.meshes.export.write_vtu` writes for the whole mesh.
"""

from __future__ import annotations

import base64
import tempfile
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import IO, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tusqh.atomic import replacing
from tusqh.meshes.export import field_data, number_of_unit

#: Bytes of a block, which is compressed by itself.
_BLOCK = 32768
#: Bytes that are encoded at a time: whole blocks of base64.
_AT_A_TIME = 3 * 2**20
_VTK_TYPES = {"int8": "Int8", "int32": "Int32", "int64": "Int64", "float64": "Float64"}


class Stream(NamedTuple):
    """An array that is too large for memory.

    Parameters
    ----------
    section
        Part of the file: ``Points``, ``Cells`` or ``CellData``.
    name
        Name of the array.
    parts
        Its parts, in order, all of one type.
    n_components
        Number of columns; 0 for arrays with one axis.
    """

    section: str
    name: str
    parts: Iterator[NDArray[np.generic]]
    n_components: int = 0


def write_streamed(
    path: Path, n_points: int, n_cells: int, arrays: Iterator[Stream], unit: str = ""
) -> None:
    """Write a VTU file; it appears complete or not at all.

    Parameters
    ----------
    path
        File to write, ending in ``.vtu``.
    n_points, n_cells
        Number of points and of elements.
    arrays
        The arrays in the order of the file, those of one section together.
    unit
        Unit of length of the points; empty if it is not known.
    """
    import meshio

    with replacing(path) as temporary, temporary.open("wb") as out:
        head = (
            '<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="0.1" '
            'byte_order="LittleEndian" compressor="vtkZLibDataCompressor">\n'
            f"<!--This file was created by meshio v{meshio.__version__}-->\n<UnstructuredGrid>"
        )
        data = field_data(number_of_unit(unit)).decode() if unit else ""
        head += f'{data}\n<Piece NumberOfPoints="{n_points}" NumberOfCells="{n_cells}">\n'
        out.write(head.encode())
        section = ""
        for array in arrays:
            if array.section != section:
                end = f"</{section}>\n" if section else ""
                out.write(f"{end}<{array.section}>\n".encode())
                section = array.section
            _write_array(out, array, path.parent)
        out.write(f"</{section}>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n".encode())


def _write_array(out: IO[bytes], array: Stream, folder: Path) -> None:
    """Write one array; its compressed blocks wait in a file, because their sizes come first."""
    sizes: list[int] = []
    kind, last = "", 0
    with tempfile.TemporaryFile(dir=folder) as blocks:
        rest = b""
        for part in array.parts:
            kind = _VTK_TYPES[part.dtype.name]
            content = rest + np.ascontiguousarray(part).tobytes()
            n_whole = len(content) // _BLOCK * _BLOCK
            for start in range(0, n_whole, _BLOCK):
                sizes.append(blocks.write(zlib.compress(content[start : start + _BLOCK])))
            last, rest = _BLOCK, content[n_whole:]
        if rest:
            sizes.append(blocks.write(zlib.compress(rest)))
            last = len(rest)
        columns = f' NumberOfComponents="{array.n_components}"' if array.n_components else ""
        out.write(
            f'<DataArray type="{kind}" Name="{array.name}"{columns} format="binary">\n'.encode()
        )
        header = np.array([len(sizes), _BLOCK, last, *sizes], dtype=np.uint32)
        out.write(base64.b64encode(header.tobytes()))
        blocks.seek(0)
        while content := blocks.read(_AT_A_TIME):
            out.write(base64.b64encode(content))
        out.write(b"\n</DataArray>\n")
