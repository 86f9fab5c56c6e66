"""Stage 5: build the manifold mesh at the chosen threshold, and its certificate."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from tusqh.antialias.cells import CellSets
from tusqh.antialias.resolve import Resolved, build_mesh, describe_mesh
from tusqh.atomic import write_text
from tusqh.certificate import make_certificate
from tusqh.errors import TopologyError
from tusqh.hashing import canonical_json
from tusqh.local_topology.feature_cells import repeat_choice
from tusqh.local_topology.move import LocalCells, changes_of
from tusqh.meshes.checks import Check
from tusqh.meshes.export import write_vtu
from tusqh.meshes.volume_mesh import VolumeMesh
from tusqh.pipeline.original import Original, to_warnings
from tusqh.quality.comparison import OTHER_BASE, OTHER_THRESHOLD
from tusqh.quality.verification import verify_mesh
from tusqh.sampling.doubled_grid import RESOLUTION
from tusqh.sampling.fractions import VolumeFractions
from tusqh.sampling.reference import Reference
from tusqh.tables import write_csv
from tusqh.threshold.selection import Selection


@dataclass(frozen=True)
class Built:
    """A mesh with the fractions and the selection from which it was made.

    Parameters
    ----------
    selection
        The threshold and the reason for its choice.
    fractions
        The volume fractions to which the threshold was applied.
    resolved
        The mesh with its cells, decisions, bridges, and the removed and filled features.
    reference
        The volume that the mesh should have, if the geometry was given.
    original
        The geometry and the settings with which the mesh was compared, if they were given.
    comparison
        Checks of the mesh against the geometry, if it was given.
    """

    selection: Selection
    fractions: VolumeFractions
    resolved: Resolved
    reference: Reference | None = None
    original: Original | None = None
    comparison: tuple[Check, ...] = ()

    @cached_property
    def facts(self) -> dict[str, Any]:
        """Numbers and names that describe the mesh, for tables."""
        return {
            "threshold": self.selection.threshold,
            "margin": self.selection.margin,
            **describe_mesh(self.resolved, self.fractions),
            **self._local_facts,
            **self._reference_facts,
            **self._placement,
            "comparison": [asdict(check) for check in self.comparison],
        }

    @property
    def mesh(self) -> VolumeMesh:
        """The mesh."""
        return self.resolved.mesh

    @property
    def _placement(self) -> dict[str, Any]:
        placement = self.fractions.placement
        return {} if placement is None else {"placement": placement.to_dict()}

    @property
    def changes(self) -> pd.DataFrame:
        """The cells that differ from the base, in groups; an empty table if there is no base."""
        return changes_of(self.resolved.cells)

    @property
    def _local_facts(self) -> dict[str, Any]:
        cells = self.resolved.cells
        if not isinstance(cells, LocalCells):
            return {}
        return {
            "base": cells.base,
            "changed_cells": cells.n_changes,
            "changed_groups": len(cells.changes),
            "changed_volume": cells.changes["volume"].sum(),
            "changed_contacts": cells.n_other_contacts,
            "held_cells": cells.n_held,
            "verification": verify_mesh(self.mesh, cells, grid=self.fractions.grid.label),
        }

    @property
    def _reference_facts(self) -> dict[str, Any]:
        if self.reference is None:
            return {}
        return {
            "reference_volume": self.reference.volume,
            "reference_source": self.reference.source,
        }

    def write_mesh(self, path: Path) -> None:
        """Write the mesh as VTU, with the volume fraction of the cell in which each element lies.

        With the local scope, the cell data `change` is 1 in cells that were added to the base.

        Parameters
        ----------
        path
            File to write, ending in ``.vtu``.
        """
        cell = self.mesh.grid_cell
        place = np.unravel_index(np.maximum(cell, 0), self.fractions.grid.shape)
        in_cell = np.where(cell >= 0, self.fractions.cell_multiples[place] * RESOLUTION, 0.0)
        data = {"volume_fraction": in_cell}
        cells = self.resolved.cells
        if isinstance(cells, LocalCells):
            is_added = (cells.kept & ~cells.in_base).ravel()
            data["change"] = np.where(cell >= 0, is_added[cell], False).astype(np.float64)
        write_vtu(path, self.mesh, cell_data=data)

    def write(
        self,
        *,
        fractions: Path,
        mesh: Path,
        certificate: Path,
        features: Path,
        bridges: Path,
        changes: Path,
        facts: Path,
    ) -> None:
        """Write the mesh, its certificate and its tables.

        Parameters
        ----------
        fractions
            The existing file of fractions in the folder of the mesh; the certificate names it.
        mesh, certificate, features, bridges, changes, facts
            Files to write; the certificate measures the written mesh.

        Raises
        ------
        MeshError
            The mesh does not have the predicted topology, or a check fails.
        """
        cells = self.resolved.cells
        self.write_mesh(mesh)
        claim = make_certificate(self.selection, cells, mesh, fractions, name=self.mesh.name)
        claim |= self._placement
        if self.original is not None:
            claim["settings"] = self.original.to_dict()
        claim["warnings"] = to_warnings(self.comparison)
        write_csv(features, cells.features)
        write_csv(bridges, cells.bridge_table)
        write_csv(changes, self.changes)
        write_text(certificate, canonical_json(claim))
        write_text(facts, canonical_json(self.facts))


def build(
    fractions: VolumeFractions,
    selection: Selection,
    *,
    name: str = "model",
    original: Original | None = None,
    reference: Reference | None = None,
) -> Built:
    """Return the mesh of volume fractions at a chosen threshold, with every contact decided.

    Parameters
    ----------
    fractions
        Volume fractions.
    selection
        The threshold; if a mesh verified it, that mesh is used.
    name
        The model.
    original
        The geometry with which the mesh is compared; None: no comparison.
    reference
        The volume of the geometry, if it has already been measured.

    """
    resolved = selection.resolved
    if resolved is None or resolved.mesh.name != name:
        cell_sets = repeat_choice(
            CellSets(fractions, selection.policy), selection.base, selection.wishes
        )
        cells = selection.cells or cell_sets.at(selection.threshold)
        resolved = build_mesh(cells, fractions.grid, name=name)
    if original is None:
        return Built(selection, fractions, resolved)
    reference = reference or original.reference(fractions)
    compared = original.compare(resolved, fractions, reference)
    return Built(selection, fractions, resolved, reference, original, tuple(compared))


def require_volume(built: Built) -> None:
    """Raise an error if the volume was to be matched but no threshold does so.

    Parameters
    ----------
    built
        The mesh whose volume is the nearest to that of the geometry.

    Raises
    ------
    TopologyError
        The error of its volume exceeds the tolerance; the message gives a remedy.
    """
    check = next(check for check in built.comparison if check.id == "volume")
    if not check.holds:
        raise TopologyError(
            f"the volume of the nearest mesh is {check.found}; wanted is {built.selection.wanted}",
            where=built.mesh.name,
            expected=f"a volume {check.required}",
            remedy=check.remedy.replace(OTHER_THRESHOLD, "").replace(OTHER_BASE, "")
            + "; `--volume-tolerance` allows a larger difference",
        )
