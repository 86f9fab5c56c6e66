"""Stage 6: move the boundary of the mesh onto the geometry, and record how well that worked."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from tusqh import __version__
from tusqh.atomic import write_text
from tusqh.errors import MeshError
from tusqh.fitting import Fitted, fit_mesh
from tusqh.fitting.chains import list_chains
from tusqh.fitting.distances import measure_distances
from tusqh.fitting.fitted import FELL_BACK_COLUMNS
from tusqh.fitting.of_geometry import target_of
from tusqh.fitting.pieces import sizes_of
from tusqh.fitting.resolved import find_resolved
from tusqh.fitting.target import Target
from tusqh.grid import BackgroundGrid, BoolArray
from tusqh.hashing import canonical_json, hash_file
from tusqh.meshes.checks import Check
from tusqh.meshes.export import write_vtu
from tusqh.meshes.patches import table_of_patches
from tusqh.meshes.volume_mesh import GRID_CELL, INNER_CELL, VolumeMesh
from tusqh.pipeline.original import Original
from tusqh.quality.fit_checks import FITTED, check_fit, check_volume_again, summarise_distances
from tusqh.sampling.fractions import VolumeFractions
from tusqh.tables import write_csv
from tusqh.threshold.selection import Selection

#: The files of the stage, by their names in `tusqh.files`.
WRITTEN = ("fitted", "fit", "distances", "unfitted", "patches", "chains")


@dataclass(frozen=True)
class Fit:
    """A fitted mesh with what was measured of it.

    Parameters
    ----------
    fitted
        The mesh, its distances, and what fell back.
    staircase
        The mesh before.
    target
        Where its boundary should lie.
    fractions
        The fractions of which the mesh was made.
    about
        The facts about the staircase, see `tusqh.pipeline.build.Built.facts`.
    tolerance
        Largest relative difference of the volumes without a warning.
    """

    fitted: Fitted
    staircase: VolumeMesh
    target: Target
    fractions: VolumeFractions
    about: Mapping[str, Any]
    tolerance: float = 0.05

    @property
    def mesh(self) -> VolumeMesh:
        """The fitted mesh."""
        return self.fitted.mesh

    @cached_property
    def comparison(self) -> tuple[Check, ...]:
        """The volume and the distances of the fitted mesh against the geometry, and warnings."""
        volume = self.mesh.measurement.volume
        stored = [Check(**check) for check in self.about["comparison"]]
        n_boundary = len(np.unique(self.mesh.facets.boundary))
        return (
            *check_volume_again(stored, self.about, volume, self.tolerance),
            *check_fit(
                self.fitted.distances,
                self.fitted.fell_back,
                n_boundary=n_boundary,
                cell_size=self.fractions.grid.cell_size,
                unresolved=self.unresolved,
            ),
        )

    @cached_property
    def chains(self) -> pd.DataFrame:
        """The creases of the geometry, see `tusqh.fitting.chains.list_chains`."""
        return list_chains(self.fitted, self.target)

    @cached_property
    def unresolved(self) -> float:
        """Share of the trusted surface at walls and gaps thinner than a cell."""
        sizes = sizes_of(self.target.pieces)
        is_fine = ~find_resolved(self.target)[self.target.sample]
        return float(sizes[is_fine].sum() / max(sizes.sum(), 1e-300))

    @cached_property
    def facts(self) -> dict[str, Any]:
        """Numbers that differ from those of the staircase, and those of the fit."""
        measured = self.mesh.measurement
        scaled = self.mesh.jacobians.scaled
        return {
            "elements": self.mesh.n_cells,
            "points": len(self.mesh.points),
            "volume": measured.volume,
            "betti_measured": list(measured.by_euler),
            "comparison": [asdict(check) for check in self.comparison],
            "fit": {
                "trusted": self.target.trusted,
                "unresolved": self.unresolved,
                "min_scaled_jacobian": measured.smallest_scaled_jacobian,
                "share_below_0_3": float((scaled < 0.3).mean()),
                **summarise_distances(self.fitted.distances),
                "fell_back": int(self.fitted.fell_back["points"].sum()),
            },
        }

    def write_mesh(self, path: Path) -> None:
        """Write the fitted mesh as VTU, with the volume fraction of the cell of each element.

        Parameters
        ----------
        path
            File to write, ending in ``.vtu``.
        """
        cell = self.mesh.grid_cell
        in_cell = np.where(cell >= 0, self.fractions.cells.ravel()[cell], 0.0)
        write_vtu(path, self.mesh, cell_data={"volume_fraction": in_cell})

    def write(self, *, mesh: Path, **paths: Path) -> None:
        """Write the fitted mesh, its tables, and the record that `tusqh check` recomputes.

        Parameters
        ----------
        mesh
            The existing file of the staircase; the record names it.
        **paths
            The files `WRITTEN` to write.

        Raises
        ------
        MeshError
            The fitted mesh does not have the topology of the staircase, or a check fails.
        """
        self.write_mesh(paths["fitted"])
        write_csv(paths["distances"], self.fitted.distances)
        write_csv(paths["unfitted"], self.fitted.fell_back)
        write_csv(paths["chains"], self.chains)
        write_csv(paths["patches"], table_of_patches(self.mesh, self.fitted.patch))
        write_text(paths["fit"], canonical_json(self.record(mesh, paths["fitted"])))

    def record(self, mesh: Path, fitted: Path) -> dict[str, Any]:
        """Return the record of the fit, as plain values.

        Parameters
        ----------
        mesh, fitted
            The written files of the staircase and of the fitted mesh.

        Raises
        ------
        MeshError
            The fitted mesh does not have the topology of the staircase, or a check fails.
        """
        measured, before = self.mesh.measurement, self.staircase.measurement
        if not (measured.is_sound and measured.has_topology(before.by_euler)):
            raise MeshError(
                f"the fitted mesh has Betti numbers {measured.by_euler} and "
                f"{measured.by_boundary}, failed checks: "
                f"{'; '.join(check.name for check in measured.failed) or 'none'}",
                where=self.mesh.name,
                expected=f"the Betti numbers {before.by_euler} of the staircase, no failed check",
                remedy="this is a fault of tusqh: please report it; `--no-fit` gives the staircase",
            )
        return {
            "fit": 1,
            "model": self.mesh.name,
            "tusqh": __version__,
            "mesh": {"file": mesh.name, "sha256": hash_file(mesh)},
            "fitted": {"file": fitted.name, "sha256": hash_file(fitted)},
            "measured": {"euler": list(measured.by_euler), "boundary": list(measured.by_boundary)},
            "distances": _plain(self.fitted.distances),
            "all_distances": _plain(measure_distances(self.mesh, self.target)),
            "unfitted": _plain(self.fitted.fell_back),
            "facts": self.facts,
        }


def fit(
    mesh: VolumeMesh,
    selection: Selection,
    fractions: VolumeFractions,
    original: Original,
    about: Mapping[str, Any],
) -> Fit:
    """Return a mesh with its boundary moved onto the geometry.

    Parameters
    ----------
    mesh
        The staircase.
    selection
        The threshold, with its base if the scope is local.
    fractions
        The fractions of which it was made.
    original
        The geometry, and how it was sampled.
    about
        The facts about the staircase, see `tusqh.pipeline.build.Built.facts`.
    """
    target = find_target(mesh, selection, fractions, original)
    base = selection.base or selection.threshold
    fitted = fit_mesh(mesh, target, cell_size=fractions.grid.cell_size, threshold=base)
    if not _is_good(fitted.mesh):
        fitted = _staircase(mesh, target, fitted)
    tolerance = original.quality.volume_tolerance
    return Fit(fitted, mesh, target, fractions, about, tolerance)


def find_target(
    mesh: VolumeMesh, selection: Selection, fractions: VolumeFractions, original: Original
) -> Target:
    """Return where the boundary of a mesh should lie.

    Parameters
    ----------
    mesh, selection, fractions, original
        See `fit`.
    """
    grid, sides = fractions.grid, None
    if original.window is not None:
        sides = original.window.box
    elif original.sampling.domain == "outside":
        corners = grid.to_points(np.array([(0,) * grid.dim, grid.shape]))
        sides = tuple(corners[0].tolist()), tuple(corners[1].tolist())
    base = selection.base or selection.threshold
    return target_of(
        original.geometry,
        fractions,
        sampling=original.sampling,
        sides=sides,
        changed=_kept_cells(mesh, grid) != (fractions.cells >= base),
    )


def load_fit(path: Path) -> dict[str, Any]:
    """Return the record of a fit.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    MeshError
        It cannot be read.
    """
    try:
        stored = dict(json.loads(path.read_text("utf-8")))
        missing = {"mesh", "fitted", "measured", "all_distances", "facts"} - set(stored)
    except (OSError, ValueError) as reason:
        raise _wrong(path, str(reason)) from reason
    if missing:
        raise _wrong(path, f"lacks {', '.join(sorted(missing))}")
    return stored


def read_facts(facts: Path, fit: Path | None = None) -> dict[str, Any]:
    """Return the facts about the mesh that is used: of the fitted one, if there is one.

    Parameters
    ----------
    facts
        The facts about the staircase.
    fit
        The record of its fit; None: the staircase is used.
    """
    found = dict(json.loads(facts.read_text("utf-8")))
    return found if fit is None else found | load_fit(fit)["facts"]


def _wrong(path: Path, found: str) -> MeshError:
    return MeshError(
        f"is not a valid record of a fit: {found}",
        where=str(path),
        expected="a file that the step `fit` wrote, unchanged",
        remedy="make the mesh again, or check the mesh in another folder",
    )


def _kept_cells(mesh: VolumeMesh, grid: BackgroundGrid) -> BoolArray:
    """Return the cells of the grid that a mesh has, shape n."""
    kept = np.zeros(grid.n_cells, dtype=np.bool_)
    kept[mesh.grid_cell[np.isin(mesh.kind, (GRID_CELL, INNER_CELL))]] = True
    return kept.reshape(grid.shape)


def _is_good(mesh: VolumeMesh) -> bool:
    """Return whether a fitted mesh is sound and no element is worse than allowed."""
    measured = mesh.measurement
    return measured.is_sound and FITTED.allows(measured.smallest_scaled_jacobian, mesh)


def _staircase(mesh: VolumeMesh, target: Target, fitted: Fitted) -> Fitted:
    """Return the staircase as the result of a fit that has elements worse than allowed."""
    columns = [c for c in FELL_BACK_COLUMNS if c in "xyz"[: mesh.dim] or len(c) > 1]
    corners = mesh.points[np.unique(mesh.facets.boundary)]
    why = f"the worst element has {fitted.mesh.measurement.smallest_scaled_jacobian:.3f}"
    row = (*corners.mean(axis=0), len(corners), "the staircase stays", why)
    rows = pd.DataFrame([row], columns=columns)
    rows = pd.concat([fitted.fell_back, rows], ignore_index=True) if len(fitted.fell_back) else rows
    return Fitted(mesh, measure_distances(mesh, target), rows, fitted.facts)


def _plain(table: pd.DataFrame) -> list[dict[str, Any]]:
    return list(json.loads(table.to_json(orient="records", double_precision=15)))
