"""Compare a mesh with its geometry; the differences are warnings in the verdict, with remedies."""

from __future__ import annotations

from typing import Protocol

from tusqh.antialias.cells import CellSet
from tusqh.antialias.resolve import Resolved
from tusqh.geometry.kinds import Geometry
from tusqh.geometry.soup import Soup
from tusqh.geometry.soup_facts import SoupFacts
from tusqh.grid import BackgroundGrid
from tusqh.grid.components import count_touching_cells
from tusqh.local_topology.move import LocalCells
from tusqh.meshes.checks import Check
from tusqh.quality.thickness import measure_thickness
from tusqh.sampling.reference import Reference

#: A mesh whose relative volume error exceeds this is not suitable.
FAR_OFF = 0.5

#: The part of the remedy for volumes that does not apply if the volume was to be matched.
OTHER_THRESHOLD = ", another threshold, or `--match-volume`"

#: The same with the local scope, where the base decides on most cells.
OTHER_BASE = ", another base (`--base`), or `--base match`"

#: Components of at most this many cells along each axis are small.
_SMALL = 2

#: Smallest shares that cause a warning.
_AMBIGUOUS, _INCONSISTENT, _TIED, _THIN = 0.1, 0.01, 0.05, 0.1

#: Smallest share of material in thin walls for a warning; in 2D, coasts are rough at any scale.
_THIN_MATERIAL = {2: 0.1, 3: 0.01}


class Compared(Protocol):
    """Volume fractions of a grid, as a whole or in slabs."""

    @property
    def grid(self) -> BackgroundGrid:
        """The background grid."""

    def count_ties(self, threshold: float) -> int:
        """Return the number of cells whose fraction is the threshold itself.

        Parameters
        ----------
        threshold
            Volume fraction, dimensionless.
        """


def compare_with_geometry(
    resolved: Resolved,
    fractions: Compared,
    geometry: Geometry,
    reference: Reference,
    *,
    tolerance: float = 0.05,
) -> list[Check]:
    """Return the differences between a mesh and its geometry: the volume check and all warnings.

    Parameters
    ----------
    resolved
        The mesh and its cells.
    fractions
        The volume fractions from which it was made.
    geometry
        The geometry.
    reference
        The volume that the mesh should have.
    tolerance
        Largest relative difference of the volumes without a warning.

    Returns
    -------
    checks
        The check of the volume, and those other checks that fail.
    """
    geometry = reference.geometry or geometry
    size = fractions.grid.cell_size
    thin = [] if reference.is_made else _thin_walls(reference, geometry, size)
    checks = [_volume(resolved, reference, thin, tolerance), *thin]
    checks += _small_components(resolved.cells, fractions)
    checks += _ties(resolved.cells, fractions)
    if reference.ambiguity > _AMBIGUOUS:
        checks.append(
            _warning(
                "open_surface",
                "the surface is open",
                f"{reference.ambiguity:.2g} times as many samples are between inside and outside "
                "as inside",
                f"<= {_AMBIGUOUS:g} times as many",
                "close the surface, or check the mesh in a viewer: what is inside is a guess",
            )
        )
    if isinstance(geometry, Soup) and not reference.is_made:
        checks += _inconsistent_edges(geometry)
    return checks


def _volume(resolved: Resolved, reference: Reference, thin: list[Check], tolerance: float) -> Check:
    name = f"{'area' if resolved.mesh.dim == 2 else 'volume'} of the mesh"
    required = f"within {100 * tolerance:g} % of {reference.source}"
    if reference.volume <= 0:
        return _warning(
            "volume",
            name,
            "unknown: the geometry encloses nothing",
            required,
            "close the surface, or use `--orientation flip` if its parts are inside out",
        )
    ratio = resolved.mesh.measurement.volume / reference.volume
    error = abs(ratio - 1)
    remedy = ""
    if error > tolerance:
        is_local = isinstance(resolved.cells, LocalCells)
        remedy = "use smaller cells (`--cells`)" + (OTHER_BASE if is_local else OTHER_THRESHOLD)
        remedy = "; ".join(f"{check.found}: {check.remedy}" for check in thin) or remedy
    features = resolved.cells.features
    is_component = features["feature"] == "component"
    given_up = float(features["volume"].where(is_component, -features["volume"]).sum())
    if len(features) and error > tolerance:
        remedy = f"{len(features):,} features were removed or filled as requested; else {remedy}"
    return Check(
        id="volume",
        name=name,
        found=f"{ratio:.4f} of {reference.source}",
        required=f"within {100 * tolerance:g} %",
        holds=error <= tolerance,
        # The volume of features that were removed or filled on request is not an error.
        is_warning=min(error, abs(ratio + given_up / reference.volume - 1)) <= FAR_OFF,
        remedy=remedy,
    )


def _thin_walls(reference: Reference, geometry: Geometry, size: float) -> list[Check]:
    """Return a warning if much of the surface bounds walls thinner than a cell."""
    if reference.volume <= 0 or reference.ambiguity > _AMBIGUOUS:
        return []
    thickness = measure_thickness(
        geometry, is_outside=reference.is_outside, window=reference.window
    )
    share = 0.0 if thickness is None else thickness.share_below(size)
    if thickness is None or share <= _THIN:
        return []
    dim = len(geometry.bounding_box()[0])
    if thickness.material_below(size) <= _THIN_MATERIAL[dim] * reference.volume:
        return []
    return [
        _warning(
            "thin_walls",
            "walls thinner than a cell",
            f"{100 * share:.0f} % of the surface bounds walls thinner than a cell of {size:.4g}",
            f"<= {100 * _THIN:g} % of the surface",
            f"use `--cell-size {thickness.resolving:.3g}`, which resolves them",
        )
    ]


def _small_components(cells: CellSet, fractions: Compared) -> list[Check]:
    """Return a warning if components of the kept cells are small."""
    # Cells that touch at a vertex count as joined, as if a pinch connected them.
    n_cells = count_touching_cells(cells.kept)
    n, few = len(n_cells), _SMALL**fractions.grid.dim
    n_small = int((n_cells <= few).sum())
    if n_small == 0:
        return []
    return [
        _warning(
            "small_components",
            "components of few cells",
            f"{n:,} component{'s' if n > 1 else ''}, {n_small:,} of at most {few} cells",
            "0",
            f"use cells of at most {fractions.grid.cell_size / 2:.4g} (`--cell-size`) to resolve "
            f"them, or remove them with `--min-cells {few + 1}`",
        )
    ]


def _ties(cells: CellSet, fractions: Compared) -> list[Check]:
    """Return a warning if the fraction of many cells equals the threshold."""
    n_tied = fractions.count_ties(cells.threshold_of_cells)
    n_kept = int(cells.kept.sum())
    if n_tied <= _TIED * n_kept:
        return []
    return [
        _warning(
            "ties",
            "cells whose fraction is the threshold itself",
            f"{n_tied:,} of {n_kept:,} kept cells",
            f"<= {100 * _TIED:g} %",
            "shift the grid by part of a cell with `--offset`, or use a threshold a little above "
            "or below: the mesh loses those cells at any higher threshold",
        )
    ]


def _inconsistent_edges(soup: Soup) -> list[Check]:
    facts = SoupFacts(soup)
    is_bad = (facts.n_faces == 2) & (facts.n_forward != 1)
    n_bad, n_edges = int(is_bad.sum()), len(is_bad)
    if n_bad <= _INCONSISTENT * n_edges:
        return []
    return [
        _warning(
            "inconsistent_edges",
            "edges between triangles of opposite orientation",
            f"{n_bad:,} of {n_edges:,} edges",
            f"<= {100 * _INCONSISTENT:g} %",
            "orient the triangles consistently in the program that made the file",
        )
    ]


def _warning(identifier: str, name: str, found: str, required: str, remedy: str) -> Check:
    return Check(
        id=identifier,
        name=name,
        found=found,
        required=required,
        holds=False,
        is_warning=True,
        remedy=remedy,
    )
