"""The mesh of several materials with its tables, verdict and files."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd

from tusqh.contacts import MaterialFractions, MaterialMesh
from tusqh.contacts.pairs import tabulate_pairs
from tusqh.geometry.remark import Remark
from tusqh.grid import FloatArray
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.topology.betti_numbers import BettiNumbers

__all__ = ["MaterialsResult"]

#: Name of the row of all materials together, without the void.
ALL = "all"

#: Columns of `MaterialsResult.materials`.
MATERIAL_COLUMNS = (
    ["material", "threshold", "elements", "volume", "volume_of_geometry"]
    + [f"betti_{k}_{how}" for how in ("predicted", "measured") for k in range(3)]
    + ["manifold", "min_scaled_jacobian", "holds"]
)


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
    """

    built: MaterialMesh
    fractions: MaterialFractions
    thresholds: dict[str, float]
    overlaps: FloatArray | None = None
    remarks: tuple[Remark, ...] = ()

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
        volumes = self.fractions.volumes()
        volumes[ALL] = sum(volumes[name] for name in self.names[:-1])
        measured = {**self.built.measured, ALL: self.built.measured_solid}
        predicted = {**self.built.predicted, ALL: self.built.predicted_solid}
        is_sound = self.mesh.measurement.is_sound
        rows = []
        for name, found in measured.items():
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
            "remarks": [str(remark) for remark in self.remarks],
        }

    def write(self, path: Path | str) -> None:
        """Write all elements with their materials: .vtu, .mesh, .msh, .exo or .inp.

        Parameters
        ----------
        path
            File to write; its suffix names the format.

        Raises
        ------
        MeshError
            The suffix names no format.
        """
        self.built.write(Path(path))

    def __repr__(self) -> str:
        return f"mesh of {self.mesh.name}\n{self.materials.to_string(index=False)}"


def _in_columns(how: str, betti: BettiNumbers) -> dict[str, int]:
    """Return Betti numbers by the names of their columns."""
    return {f"betti_{k}_{how}": n for k, n in enumerate(betti)}
