"""The result of meshing: the mesh with prediction, choice, measurement, verdict and tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from tusqh.atomic import write_text
from tusqh.coarsening import CoarseMesh, ConformingMesh
from tusqh.coarsening.files import write_coarse
from tusqh.files import path_of
from tusqh.geometry.canonical import write_geometry
from tusqh.geometry.kinds import Geometry
from tusqh.geometry.remark import Remark
from tusqh.hashing import canonical_json
from tusqh.meshes.formats import Export, write_mesh
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.pipeline.build import Built
from tusqh.pipeline.coarsen import WRITTEN as OF_COARSE
from tusqh.pipeline.coarsen import Coarsened
from tusqh.pipeline.exports import export_of
from tusqh.pipeline.ingest import describe_geometry
from tusqh.pipeline.judge import Judgement
from tusqh.pipeline.persistence import Persistence
from tusqh.pipeline.report import Report
from tusqh.pipeline.select import Choice
from tusqh.sampling.fractions import VolumeFractions
from tusqh.sampling.io import save_fractions
from tusqh.settings.model import Settings
from tusqh.tables import write_csv
from tusqh.threshold.selection import Selection

if TYPE_CHECKING:
    from tusqh.pipeline.fit import Fit

__all__ = ["Result"]


@dataclass(frozen=True, repr=False)
class Result:
    """A mesh with all intermediate results.

    Parameters
    ----------
    geometry
        The outline, soup or image, without repair.
    fractions
        Volume fractions of cells and sub-cells.
    persistence
        Betti curves and persistence diagram of the fractions.
    choice
        The chosen threshold, the topology at every threshold, and the candidates.
    built
        The mesh, with cells, decisions, bridges, and the removed and filled features.
    judgement
        All checks of the mesh.
    settings
        The settings, as in a model's block of the configuration but without its `geometry`.
    reading
        Description of the reading, see `tusqh.pipeline.describe_reading.describe_reading`.
    remarks
        Remarks on what reading and orienting the geometry left out, changed or noted.
    fit
        The fitted mesh, where the settings ask for it.
    coarsened
        The coarse mesh, where the settings ask for it.
    """

    geometry: Geometry
    fractions: VolumeFractions
    persistence: Persistence
    choice: Choice
    built: Built
    judgement: Judgement
    settings: Settings
    reading: dict[str, Any]
    remarks: tuple[Remark, ...] = ()
    fit: Fit | None = None
    coarsened: Coarsened | None = None

    @property
    def name(self) -> str:
        """The model."""
        return self.mesh.name

    @property
    def mesh(self) -> VolumeMesh:
        """The mesh, fitted where asked: `points`, `cells`, `to_pyvista()`, `to_meshio()`, ..."""
        return self.built.mesh if self.fit is None else self.fit.mesh

    @property
    def regions(self) -> None:
        """The material of every element: there is one."""

    @property
    def coarse(self) -> CoarseMesh | ConformingMesh | None:
        """The mesh with larger elements inside; None if the settings do not ask for it."""
        return None if self.coarsened is None else self.coarsened.coarse

    @property
    def staircase(self) -> VolumeMesh:
        """The mesh before its boundary was fitted."""
        return self.built.mesh

    @property
    def facts(self) -> dict[str, Any]:
        """Numbers that describe the mesh, fitted where asked, see `Built.facts`."""
        return self.built.facts | ({} if self.fit is None else self.fit.facts)

    @cached_property
    def defects(self) -> pd.DataFrame:
        """The defects of the geometry, one row per kind."""
        return describe_geometry(self.geometry)

    @property
    def diagram(self) -> pd.DataFrame:
        """Persistence pairs, with the cells that create and destroy each class."""
        return self.persistence.diagram

    def __repr__(self) -> str:
        return f"mesh of {self.name}\n{self.report}"

    @property
    def curves(self) -> pd.DataFrame:
        """Raw Betti numbers of every plateau of the threshold."""
        return self.persistence.curves

    @property
    def topologies(self) -> pd.DataFrame:
        """Betti numbers of the meshes, by plateau of the threshold."""
        return self.choice.topologies

    @property
    def prices(self) -> pd.DataFrame:
        """The price of each way to change each class of the diagram, in cells and volume."""
        return self.choice.prices

    @property
    def selection(self) -> Selection:
        """The threshold, the reason for its choice, and the robustness of the choice."""
        return self.choice.selection

    @property
    def report(self) -> Report:
        """The report of the request, prediction, choice, measurement and verdict."""
        judged = self.judgement
        return Report(
            self.name,
            self.selection,
            self.facts,
            judged.elements,
            judged.verdict,
            self.reading,
            self.remarks,
            None if self.coarsened is None else self.coarsened.line(),
        )

    def write(
        self,
        path: Path | str,
        *,
        element: str | None = None,
        layer: float | None = None,
        sets: Sequence[str] = (),
    ) -> None:
        """Write the mesh in the format of the suffix, see `tusqh.meshes.formats.write_mesh`.

        The coarse mesh is written where the settings ask for one; with hanging vertices as .vtu
        or .mesh only.

        Parameters
        ----------
        path
            File to write.
        element
            Kind of the elements, such as ``"hex20"`` or ``"C3D8I"``; None: linear.
        layer
            Thickness of the one layer of hexes that a mesh of quads becomes; None: it stays plane.
        sets
            Names for sets of the boundary by a place, such as ``"bolt=near:30,20,0"``.

        Raises
        ------
        MeshError
            The suffix names no format, or one that cannot hold the hanging vertices of a coarse
            mesh.
        ConfigError
            The format or the mesh does not have the elements, or a set does not exist.
        """
        path, how = Path(path), self.export(element=element, layer=layer, sets=sets)
        if self.coarse is not None:
            write_coarse(path, self.coarse, how)
        elif path.suffix == ".vtu" and how.is_plain(self.mesh.dim):
            (self.built if self.fit is None else self.fit).write_mesh(path)
        else:
            write_mesh(path, self.mesh, export=how)

    def export(
        self, *, element: str | None = None, layer: float | None = None, sets: Sequence[str] = ()
    ) -> Export:
        """Return how the mesh is written.

        Parameters
        ----------
        element, layer, sets
            See `write`.
        """
        how = export_of(
            self.mesh,
            self.geometry,
            is_fitted=self.fit is not None and self.mesh is not self.staircase,
            patch=None if self.fit is None else self.fit.fitted.patch,
            element=element,
            layer=layer,
            sets=sets,
        )
        # Envelopes and shells have their own boundary, which is not the surface.
        return how if self.settings.sampling.inside == "winding" else replace(how, mover=None)

    def save(self, folder: Path | str) -> None:
        """Write all files that the workflow writes up to the verdict, under the same names.

        `tusqh check` then recomputes the certificate of ``mesh.vtu``, and of ``fitted.vtu``.

        Parameters
        ----------
        folder
            Folder to write to; it is created if it does not exist.
        """
        folder = Path(folder)
        write_geometry(path_of("geometry", folder), self.geometry)
        save_fractions(path_of("fractions", folder), self.fractions)
        tables = {
            "defects": self.defects,
            "diagram": self.diagram,
            "diagonal": self.persistence.diagonal,
            "curves": self.curves,
            "topologies": self.topologies,
            "candidates": self.choice.candidates,
            "prices": self.choice.prices,
            "elements": self.judgement.elements,
            "verdict": self.judgement.verdict,
        }
        for name, table in tables.items():
            write_csv(path_of(name, folder), table)
        write_text(path_of("reading", folder), canonical_json(self.reading))
        write_text(path_of("selection", folder), canonical_json(self.selection.to_dict()))
        written = ("fractions", "mesh", "certificate", "features", "bridges", "changes", "facts")
        self.built.write(**{name: path_of(name, folder) for name in written})
        if self.fit is not None:
            from tusqh.pipeline.fit import WRITTEN

            of_fit = {name: path_of(name, folder) for name in WRITTEN}
            self.fit.write(mesh=path_of("mesh", folder), **of_fit)
        if self.coarsened is not None:
            source = path_of("mesh" if self.fit is None else "fitted", folder)
            of_coarse = {name: path_of(name, folder) for name in OF_COARSE}
            self.coarsened.write(source=source, **of_coarse)
