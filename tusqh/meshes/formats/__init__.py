"""Write meshes in the formats of simulation programs, with named sets."""

from tusqh.meshes.formats.write import (
    SUFFIXES,
    Export,
    make_content,
    require_format,
    write_beside,
    write_mesh,
)

__all__ = ["SUFFIXES", "Export", "make_content", "require_format", "write_beside", "write_mesh"]
