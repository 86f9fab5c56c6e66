"""The mesh of several materials with its tables, verdict and files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pandas as pd

from tusqh.atomic import write_text
from tusqh.contacts import MaterialFractions, MaterialMesh
from tusqh.contacts.fractions_file import save_materials
from tusqh.contacts.material_fractions import ALL
from tusqh.contacts.mesh import round_thresholds
from tusqh.contacts.pairs import tabulate_pairs
from tusqh.files import path_of
from tusqh.geometry.remark import Remark
from tusqh.grid import FloatArray
from tusqh.hashing import canonical_json
from tusqh.local_topology.local_labels import CHANGE_COLUMNS, LocalLabels
from tusqh.local_topology.material_features import MaterialFeatures
from tusqh.local_topology.material_prices import no_material_prices, tabulate_material_prices
from tusqh.meshes.export import write_vtu
from tusqh.meshes.formats import Export
from tusqh.meshes.measure_regions import RegionMeasurement
from tusqh.meshes.regions import Regions
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.pipeline.exports import export_of
from tusqh.pipeline.judge import Judgement
from tusqh.pipeline.materials.certificate import make_certificate
from tusqh.pipeline.materials.judge import (
    compare_volumes,
    judge_all,
    volumes_of_geometry,
)
from tusqh.pipeline.materials.original import MaterialsOriginal
from tusqh.quality.verification import VERIFICATION_COLUMNS
from tusqh.tables import write_csv
from tusqh.topology.betti_numbers import BettiNumbers

__all__ = ["MaterialsResult"]

#: Columns of `MaterialsResult.materials`.
MATERIAL_COLUMNS = (
    ["material", "threshold", "elements", "volume", "volume_of_geometry"]
    + [f"betti_{k}_{how}" for how in ("predicted", "measured") for k in range(3)]
    + ["manifold", "min_scaled_jacobian", "holds"]
)


#: Largest product of the numbers of cells and of materials for which `prices` has rows.
MOST_PLACES = 500_000


@dataclass(frozen=True, repr=False)
class MaterialsResult:
    """A mesh of several materials with what led to it.

    Parameters
    ----------
    built
        The mesh with the material of every element and the predicted Betti numbers.
    fractions
        Fractions of all materials.
    thresholds
        Threshold of every material by name; only their ratios matter.
    overlaps
        Volume of material j that the earlier material i took, shape (m, m); None for labels.
    remarks
        What was left out, changed or noted in the files, and materials without cells.
    volume_tolerance
        Largest relative difference between the volumes of a material in the mesh and in its
        fractions that causes no warning.
    checks
        Whether other programs check large meshes too, see `tusqh.settings.quality.Quality`.
    original
        The geometries of the materials; None: their fractions were given.
    base
        With the local scope: the threshold of every material at the base.
    local
        With the local scope: the material of every cell, and how it differs from the base.
    """

    built: MaterialMesh
    fractions: MaterialFractions
    thresholds: dict[str, float]
    overlaps: FloatArray | None = None
    remarks: tuple[Remark, ...] = ()
    volume_tolerance: float = 0.05
    checks: Literal["all"] | None = None
    original: MaterialsOriginal | None = None
    base: dict[str, float] | None = None
    local: LocalLabels | None = None

    @property
    def mesh(self) -> VolumeMesh:
        """The mesh of all materials."""
        return self.built.mesh

    @property
    def names(self) -> tuple[str, ...]:
        """The materials; the last one is the void."""
        return self.built.names

    def part(self, name: str) -> VolumeMesh:
        """Return the mesh of one material alone, with its own points.

        Parameters
        ----------
        name
            The material.
        """
        return self.built.part(name)

    @cached_property
    def materials(self) -> pd.DataFrame:
        """One row for each material that has elements, and one for all of them together.

        The columns are `MATERIAL_COLUMNS`; volumes (2D: areas) are in model units.
        """
        volumes = volumes_of_geometry(self.fractions)
        predicted = self._predicted
        is_sound = self.mesh.measurement.is_sound
        rows = []
        for name, found in self._measured.items():
            is_manifold = found.n_non_manifold == 0
            rows.append(
                {
                    "material": name,
                    "threshold": self.thresholds.get(name),
                    "elements": found.n_cells,
                    "volume": found.volume,
                    "volume_of_geometry": volumes[name],
                    **_in_columns("predicted", predicted[name]),
                    **_in_columns("measured", found.by_euler),
                    "manifold": is_manifold,
                    "min_scaled_jacobian": round(found.smallest_scaled_jacobian, 9),
                    "holds": is_sound and is_manifold and found.has_topology(predicted[name]),
                }
            )
        return pd.DataFrame(rows, columns=MATERIAL_COLUMNS)

    @cached_property
    def pairs(self) -> pd.DataFrame:
        """Overlap, gap and interface of every two materials that have any of these.

        See `tusqh.contacts.pairs.tabulate_pairs`.
        """
        return tabulate_pairs(self.built, self.fractions, self.overlaps)

    @property
    def changes(self) -> pd.DataFrame:
        """The cells that differ from the base, see `LocalLabels.changes`; empty without a base."""
        if self.local is None:
            dim = self.fractions.grid.dim
            return pd.DataFrame(columns=[*CHANGE_COLUMNS, *"xyz"[:dim]])
        return self.local.changes

    @cached_property
    def prices(self) -> pd.DataFrame:
        """What it costs to open, cut or fill each class of each material, by itself, at the base.

        See `tusqh.local_topology.material_prices.tabulate_material_prices`.  Where the grid has
        more than `MOST_PLACES` cells for all materials together, no class has a price.
        """
        names = [name for name in self.names[:-1] if name in self.built.measured]
        if self.fractions.grid.n_cells * len(names) > MOST_PLACES:
            return no_material_prices(self.fractions.grid.dim)
        base = round_thresholds(self.names, self.base or self.thresholds)
        return tabulate_material_prices(MaterialFeatures(self.fractions, base, names))

    @cached_property
    def verdict(self) -> pd.DataFrame:
        """Every check of the mesh and of its materials, see `tusqh.quality.verdict.to_table`."""
        return self._judgement.verdict

    @property
    def elements(self) -> pd.DataFrame:
        """Summary of VTK's element metrics, one row per metric; empty if VTK did not run."""
        return self._judgement.elements

    @cached_property
    def _judgement(self) -> Judgement:
        regions = Regions(self.names, self.built.material)
        volumes = compare_volumes(
            self._measured, volumes_of_geometry(self.fractions), self.volume_tolerance
        )
        return judge_all(
            self.mesh,
            regions,
            self._measured,
            self._predicted,
            comparison=volumes,
            checks=self.checks,
        )

    @property
    def has_warnings(self) -> bool:
        """Whether a check that is only a warning fails."""
        return bool((self.verdict["holds"] == "warning").any())

    @cached_property
    def verification(self) -> pd.DataFrame:
        """One row of the verification table for every material, and one for all of them.

        The columns are those of `tusqh.quality.verification.VERIFICATION_COLUMNS`; contacts are
        those of the whole mesh.
        """
        grid, kept = self.fractions.grid, self._count_cells()
        table = self.materials.drop(columns=["volume", "volume_of_geometry"])
        table["scope"] = "global" if self.local is None else "local"
        table["model"], table["dimension"], table["grid"] = self.mesh.name, grid.dim, grid.label
        table["cells_kept"] = [kept[name] for name in table["material"]]
        table["contacts"], table["overruled"] = self.built.n_contacts, self.built.n_overruled
        table["conforming"] = self.mesh.measurement.is_conforming
        return table.reindex(columns=VERIFICATION_COLUMNS)

    def _count_cells(self) -> dict[str, int]:
        """Return the number of grid cells that every material wins, and all of them together."""
        if self.local is None:
            labels = self.fractions.label_cells(round_thresholds(self.names, self.thresholds))
        else:
            labels = self.local.labels
        counts = np.bincount(labels.ravel(), minlength=len(self.names)).tolist()
        return {**dict(zip(self.names, counts, strict=True)), ALL: sum(counts[:-1])}

    @property
    def _measured(self) -> dict[str, RegionMeasurement]:
        return {**self.built.measured, ALL: self.built.measured_solid}

    @property
    def _predicted(self) -> dict[str, BettiNumbers]:
        return {**self.built.predicted, ALL: self.built.predicted_solid}

    @property
    def is_as_predicted(self) -> bool:
        """Whether every material and all together are sound and have the predicted topology."""
        return bool(self.materials["holds"].all())

    def to_dict(self) -> dict[str, Any]:
        """Return the tables and numbers as plain values, for JSON."""
        return {
            "model": self.mesh.name,
            "materials": self.materials.to_dict("records"),
            "pairs": self.pairs.to_dict("records"),
            "contacts": self.built.n_contacts,
            "overruled": self.built.n_overruled,
            "changes": self.changes.astype(object)
            .where(self.changes.notna(), None)
            .to_dict("records"),
            "checks": self.verdict.to_dict("records"),
            "remarks": [str(remark) for remark in self.remarks],
        }

    @property
    def regions(self) -> Regions:
        """The material of every element."""
        return self.built.regions

    def export(
        self, *, element: str | None = None, layer: float | None = None, sets: Sequence[str] = ()
    ) -> Export:
        """Return how the mesh is written.

        Parameters
        ----------
        element, layer, sets
            See `tusqh.pipeline.exports.export_of`.
        """
        return export_of(self.mesh, element=element, layer=layer, sets=sets)

    def write(
        self,
        path: Path | str,
        *,
        element: str | None = None,
        layer: float | None = None,
        sets: Sequence[str] = (),
    ) -> None:
        """Write all elements with their materials, see `tusqh.meshes.formats.write_mesh`.

        With the local scope, the cell data `change` of VTU are 1 in cells with another material
        than at the base.

        Parameters
        ----------
        path
            File to write; its suffix names the format.
        element, layer, sets
            See `tusqh.pipeline.exports.export_of`.

        Raises
        ------
        MeshError
            The suffix names no format.
        """
        path = Path(path)
        export = self.export(element=element, layer=layer, sets=sets)
        if self.local is None or path.suffix != ".vtu" or not export.is_plain(self.mesh.dim):
            self.built.write(path, export)
            return
        cell = self.mesh.grid_cell
        is_changed = (self.local.labels != self.local.base).ravel()
        change = np.where(cell >= 0, is_changed[cell], False).astype(np.float64)
        write_vtu(path, self.mesh, cell_data={"change": change}, regions=self.regions)

    def save(self, folder: Path | str) -> None:
        """Write mesh, geometry, fractions, all tables and the certificate into a folder.

        `tusqh check FOLDER/mesh.vtu` then recomputes the certificate.

        Parameters
        ----------
        folder
            Folder to write to; it is created if it does not exist.
        """
        folder = Path(folder)
        self.write(path_of("mesh", folder))
        save_materials(path_of("fractions", folder), self.fractions)
        for name in ("materials", "pairs", "elements", "verdict", "verification"):
            write_csv(path_of(name, folder), getattr(self, name))
        write_csv(path_of("changes", folder), self.changes)
        write_csv(path_of("prices", folder), self.prices)
        if self.original is not None:
            self.original.save(path_of("geometry", folder))
        certificate = make_certificate(
            folder,
            self.thresholds,
            name=self.mesh.name,
            volume_tolerance=self.volume_tolerance,
            original=self.original,
            base=self.base,
            wishes=() if self.local is None else self.local.wishes,
        )
        write_text(path_of("certificate", folder), canonical_json(certificate))

    def __repr__(self) -> str:
        return f"mesh of {self.mesh.name}\n{self.materials.to_string(index=False)}"


def _in_columns(how: str, betti: BettiNumbers) -> dict[str, int]:
    """Return Betti numbers by the names of their columns."""
    return {f"betti_{k}_{how}": n for k, n in enumerate(betti)}
