"""Write a mesh in the format of a file's suffix."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from tusqh.errors import MeshError
from tusqh.meshes.choose_sets import Wish, name_sets, write_table_of_sets
from tusqh.meshes.elements import Element
from tusqh.meshes.export import write_vtu
from tusqh.meshes.formats.abaqus import write_abaqus
from tusqh.meshes.formats.content import Content
from tusqh.meshes.formats.exodus import write_exodus
from tusqh.meshes.formats.gmsh import write_gmsh
from tusqh.meshes.formats.med import write_med
from tusqh.meshes.formats.mfem import write_mfem
from tusqh.meshes.formats.nastran import write_nastran
from tusqh.meshes.formats.unv import write_unv
from tusqh.meshes.formats.vtk import write_boundary, write_quadratic
from tusqh.meshes.layer import extrude
from tusqh.meshes.quadratic import Mover, make_nodes
from tusqh.meshes.regions import Regions
from tusqh.meshes.sets import Labels, find_sets
from tusqh.meshes.volume_mesh import VolumeMesh

_WRITERS: dict[str, Callable[[Path, Content], None]] = {
    ".mesh": write_mfem,
    ".mfem": write_mfem,
    ".msh": write_gmsh,
    ".exo": write_exodus,
    ".inp": write_abaqus,
    ".bdf": write_nastran,
    ".unv": write_unv,
    ".med": write_med,
}

#: Suffixes of all formats.
SUFFIXES = (".vtu", *_WRITERS)


@dataclass(frozen=True)
class Export:
    """How meshes are written.

    Parameters
    ----------
    element
        Kind of the elements, see `tusqh.meshes.elements.ELEMENTS`; None: linear.
    layer
        Thickness of the one layer of hexes that a mesh of quads becomes; None: it stays plane.
    wishes
        Names for sets of facets by a place.
    is_smooth
        Whether the boundary was fitted, so that its sharp edges divide it.
    labels
        Further divisions of the boundary.
    mover
        Moves middle nodes of the boundary onto the geometry.
    """

    element: str | None = None
    layer: float | None = None
    wishes: Sequence[Wish] = ()
    is_smooth: bool = False
    labels: Sequence[Labels] = ()
    mover: Mover | None = None

    def is_plain(self, dim: int) -> bool:
        """Return whether files have the elements of the mesh itself.

        Parameters
        ----------
        dim
            Dimension of the mesh.
        """
        return self.layer is None and not Element.of(self.element, dim).is_quadratic


def write_mesh(
    path: Path, mesh: VolumeMesh, regions: Regions | None = None, export: Export | None = None
) -> None:
    """Write a mesh in the format of a file's suffix; the file appears complete or not at all.

    The suffixes are ``.vtu`` (VTK), ``.mesh`` or ``.mfem`` (MFEM), ``.msh`` (Gmsh 2.2 in ASCII),
    ``.exo`` (Exodus), ``.inp`` (Abaqus, CalculiX), ``.bdf`` (Nastran), ``.unv`` and ``.med``
    (Salome, code_aster).  The named sets are those of `tusqh.meshes.sets`; ``docs/outputs.md`` says
    how each format holds them.

    Parameters
    ----------
    path
        File to write.
    mesh
        The mesh.
    regions
        Material of every element; None: a single material, `solid`.
    export
        Elements, names and further divisions of the boundary.

    Raises
    ------
    MeshError
        The suffix names no format, or the mesh has no elements.
    ConfigError
        The format or the mesh does not fit what `export` asks for.
    """
    require_format(path)
    _require_elements(mesh)
    how = export or Export()
    if path.suffix == ".vtu" and how.is_plain(mesh.dim):
        write_vtu(path, mesh, regions=regions)
        return
    content = make_content(mesh, regions, how)
    if path.suffix == ".vtu":
        write_quadratic(path, content)
    else:
        _WRITERS[path.suffix](path, content)


def write_beside(
    path: Path, mesh: VolumeMesh, regions: Regions | None = None, export: Export | None = None
) -> list[Path]:
    """Write the table of sets beside a mesh file, and beside VTU the boundary; return their paths.

    Parameters
    ----------
    path
        The mesh file: ``part.vtu`` has ``part_sets.csv`` and ``part_boundary.vtu`` beside it.
    mesh, regions, export
        See `write_mesh`.

    Returns
    -------
    list of Path
        The written files.
    """
    _require_elements(mesh)
    content = make_content(mesh, regions, export or Export())
    table = path.with_name(f"{path.stem}_sets.csv")
    write_table_of_sets(table, content.mesh, content.sets)
    if path.suffix != ".vtu":
        return [table]
    boundary = path.with_name(f"{path.stem}_boundary.vtu")
    write_boundary(boundary, content)
    return [table, boundary]


def make_content(mesh: VolumeMesh, regions: Regions | None, export: Export) -> Content:
    """Return the nodes, elements and named sets of a mesh.

    Parameters
    ----------
    mesh, regions, export
        See `write_mesh`.
    """
    sets = find_sets(mesh, regions, is_smooth=export.is_smooth, labels=export.labels)
    sets = name_sets(mesh, sets, export.wishes)
    mover = export.mover
    if export.layer is not None:
        mesh, sets = extrude(mesh, sets, export.layer)
        mover = None
    element = Element.of(export.element, mesh.dim)
    return Content(mesh, sets, element, make_nodes(mesh, element, mover))


def require_format(path: Path) -> None:
    """Raise a `MeshError` if the suffix of a file names no format of `write_mesh`.

    Parameters
    ----------
    path
        File to write; only its suffix is checked.

    Raises
    ------
    MeshError
        The suffix names no format.
    """
    if path.suffix not in SUFFIXES:
        raise MeshError(
            f"the suffix {path.suffix!r} names no format",
            where=str(path),
            expected="one of " + ", ".join(SUFFIXES),
            remedy="change the suffix",
        )


def _require_elements(mesh: VolumeMesh) -> None:
    if mesh.n_cells == 0:
        raise MeshError(
            "the mesh has no elements",
            where=mesh.name,
            expected="at least one",
            remedy="lower the threshold",
        )
