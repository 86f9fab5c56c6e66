"""What `tusqh mesh` writes, besides the folder of results."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tusqh.errors import ConfigError, OutputError

if TYPE_CHECKING:
    from tusqh.pipeline.materials.result import MaterialsResult
    from tusqh.pipeline.result import Result

Paths = Annotated[
    list[Path] | None,
    typer.Option(
        "--output",
        "-o",
        help="Mesh file, by suffix: .vtu (ParaView, meshio, MFEM), .mesh or .mfem (MFEM), .msh "
        "(Gmsh, OpenFOAM, ...), .exo (Exodus), .inp (Abaqus, CalculiX), .bdf (Nastran), .unv, .med "
        "(Salome, code_aster); may be given several times. With --slabs .pvtu, which has pieces, "
        "or .vtu. (default GEOMETRY.vtu, with --slabs GEOMETRY.pvtu)",
    ),
]
Folder = Annotated[
    Path | None,
    typer.Option(
        "--results",
        help="Folder for everything that led to the mesh: diagram, certificate, verdict, ...",
    ),
]
ElementName = Annotated[
    str | None,
    typer.Option(
        "--element",
        help="Elements of the files: hex20, hex27, quad8 or quad9, or a type of Abaqus, such as "
        "C3D8I, C3D20R, DC3D8, CPE4 or DC2D4. Middle nodes lie on the geometry with --fit. "
        "(default: linear; C3D8, CPS4)",
        metavar="NAME",
    ),
]
Layer = Annotated[
    float | None,
    typer.Option(
        "--layer",
        help="Write a mesh in the plane as one layer of hexes of this thickness, with the sets "
        "front and back, as OpenFOAM needs it.",
        metavar="H",
    ),
]
Names = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        help="Name for the set of the boundary nearest to a place: bolt=near:30,20,0 for a hole, "
        "or another kind in place of near, as lid=plane:0,0,9. May be given several times.",
        metavar="NAME=near:X,Y,Z",
    ),
]
Tables = Annotated[
    bool | None,
    typer.Option(
        "--sets/--no-sets",
        help="Write NAME_sets.csv, the table of all named sets, and beside .vtu NAME_boundary.vtu, "
        "the boundary with its sets. (default: the table, beside files other than .vtu)",
        show_default=False,
    ),
]
Picture = Annotated[
    Path | None,
    typer.Option("--picture", help="Picture of the mesh with its named sets, .png, .svg or .pdf."),
]


@dataclass(frozen=True)
class Outputs:
    """The files to write.

    Parameters
    ----------
    paths
        Mesh files.
    results
        Folder for everything that led to the mesh; None: it is not written.
    element, layer, sets
        How mesh files are written, see `tusqh.pipeline.exports.export_of`.
    with_tables
        Whether the tables of sets are written; None: beside files other than VTU.
    picture
        Picture of the mesh; None: there is none.
    in_slabs
        Whether the mesh is made in slabs, which have fewer formats and no sets.
    """

    paths: Sequence[Path]
    results: Path | None = None
    element: str | None = None
    layer: float | None = None
    sets: Sequence[str] = ()
    with_tables: bool | None = None
    picture: Path | None = None
    in_slabs: bool = False

    def require(self, geometries: Sequence[str], *, has_hanging: bool = False) -> None:
        """Raise before any work when a file cannot be written.

        Parameters
        ----------
        geometries
            The files of the geometry, which must not be replaced.
        has_hanging
            Whether the mesh has hanging vertices, for which there are fewer formats.

        Raises
        ------
        OutputError
            A file cannot be written, or would replace a geometry.
        MeshError
            A suffix names no format.
        ConfigError
            The element does not exist, or a wish for a set cannot be read.
        """
        from tusqh.atomic import require_writable
        from tusqh.coarsening.files import require_coarse_format
        from tusqh.meshes.choose_sets import Wish
        from tusqh.meshes.elements import require_element
        from tusqh.meshes.formats import require_format

        require_suffix = require_format
        if self.in_slabs:
            from tusqh.pipeline.slabs.write import require_slab_format as require_suffix
        self._require_possible()
        require_element(self.element)
        for text in self.sets:
            Wish.read(text)
        existing = [Path(geometry) for geometry in geometries if Path(geometry).exists()]
        for path in self.paths:
            require_suffix(path)
            if has_hanging:
                require_coarse_format(path, element=self.element, layer=self.layer)
            require_writable(path)
            if path.exists() and any(path.samefile(geometry) for geometry in existing):
                raise OutputError(
                    "the mesh would replace the geometry",
                    where=str(path),
                    expected="another name for the mesh",
                    remedy=f"add for instance -o {path.with_stem(path.stem + '_mesh')}",
                )
        if self.results is not None:
            require_writable(self.results / "mesh.vtu")
        if self.picture is not None:
            require_writable(self.picture)
            if self.picture.suffix not in (".png", ".svg", ".pdf"):
                raise ConfigError(
                    f"the suffix {self.picture.suffix!r} names no format of pictures",
                    where="option --picture",
                    expected=".png, .svg or .pdf",
                    remedy="change the suffix",
                )

    def _require_possible(self) -> None:
        """Raise an error if a mesh in slabs is to have what needs the whole mesh."""
        options = {
            "--element": self.element,
            "--layer": self.layer,
            "--set": self.sets or None,
            "--sets": self.with_tables or None,
            "--picture": self.picture,
        }
        given = [option for option, value in options.items() if value is not None]
        if self.in_slabs and given:
            raise ConfigError(
                f"{' and '.join(given)} with --slabs",
                where="tusqh mesh",
                expected="options that do not need the mesh in one piece",
                remedy=f"leave out --slabs, or {' and '.join(given)}",
            )

    def write(self, result: Result | MaterialsResult) -> list[Path]:
        """Write all files, and return their paths.

        Parameters
        ----------
        result
            The mesh.

        Returns
        -------
        list of Path
            The files and folders.
        """
        from tusqh.meshes.formats import write_beside

        written: list[Path] = []
        if self.results is not None:
            result.save(self.results)
        how = result.export(element=self.element, layer=self.layer, sets=self.sets)
        for path in self.paths:
            result.write(path, element=self.element, layer=self.layer, sets=self.sets)
            written.append(path)
            wanted = path.suffix != ".vtu" if self.with_tables is None else self.with_tables
            if wanted:
                written += write_beside(path, result.mesh, result.regions, how)
        if self.picture is not None:
            self._draw(result)
            written.append(self.picture)
        if self.results is not None:
            written.append(self.results)
        return list(dict.fromkeys(written))

    def _draw(self, result: Result | MaterialsResult) -> None:
        from tusqh.figures.sets import draw_sets
        from tusqh.figures.style import save
        from tusqh.meshes.formats import make_content

        assert self.picture is not None
        how = result.export(sets=self.sets)
        content = make_content(result.mesh, result.regions, how)
        save(draw_sets(content.mesh, content.sets), self.picture)
