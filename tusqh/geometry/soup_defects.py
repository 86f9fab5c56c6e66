"""The kinds of defect of a soup."""

from __future__ import annotations

import numpy as np

from tusqh.geometry.defect import AREA, DIMENSIONLESS, LENGTH, NOT_MEASURED, VOLUME, defect
from tusqh.geometry.soup_facts import SoupFacts
from tusqh.grid import BoolArray

Found = tuple[int, float]


@defect(AREA, "all triangles; their total area")
def _triangles(facts: SoupFacts) -> Found:
    """Count all triangles."""
    return len(facts.triangles), float(facts.areas.sum())


@defect(LENGTH, "objects or solids of the file; longest side of the bounding box")
def _parts(facts: SoupFacts) -> Found:
    """Count parts."""
    low, high = facts.soup.bounding_box()
    return len(np.unique(facts.soup.parts)), float(np.subtract(high, low).max())


@defect(DIMENSIONLESS, "components of triangles that share edges")
def _shells(facts: SoupFacts) -> Found:
    """Count components."""
    return facts.n_shells, NOT_MEASURED


@defect(LENGTH, "edges of one triangle only; their total length")
def _boundary_edges(facts: SoupFacts) -> Found:
    """Count edges in the boundary of the surface."""
    return _chosen(facts, facts.n_faces == 1)


@defect(LENGTH, "edges of more than two triangles; their total length")
def _non_manifold_edges(facts: SoupFacts) -> Found:
    """Count edges where more than two triangles meet."""
    return _chosen(facts, facts.n_faces > 2)


@defect(DIMENSIONLESS, "points at which the triangles form more than one fan")
def _non_manifold_vertices(facts: SoupFacts) -> Found:
    """Count points with several fans."""
    return facts.n_non_manifold_vertices, NOT_MEASURED


@defect(LENGTH, "edges that both of their triangles traverse in the same direction")
def _inconsistent_edges(facts: SoupFacts) -> Found:
    """Count edges between triangles of opposite orientation."""
    return _chosen(facts, (facts.n_faces == 2) & (facts.n_forward != 1))


@defect(DIMENSIONLESS, "triangles with the same corners as an earlier one, in any order")
def _duplicate_triangles(facts: SoupFacts) -> Found:
    """Count surplus copies."""
    n_distinct = len(np.unique(np.sort(facts.triangles, axis=1), axis=0))
    return len(facts.triangles) - n_distinct, NOT_MEASURED


@defect(LENGTH, "triangles without an area; their longest side")
def _degenerate_triangles(facts: SoupFacts) -> Found:
    """Count triangles without area."""
    flat = facts.is_degenerate
    return int(flat.sum()), float(facts.longest_sides[flat].max(initial=0.0))


@defect(DIMENSIONLESS, "triangles that cross another one, by pymeshlab; -1 if not installed")
def _self_intersecting_triangles(facts: SoupFacts) -> Found:
    """Count triangles that cross others."""
    return facts.n_self_intersecting, NOT_MEASURED


@defect(
    DIMENSIONLESS,
    "edges not traversed equally often in both directions: the boundary in the sense of the "
    "winding number",
)
def _unbalanced_edges(facts: SoupFacts) -> Found:
    """Count edges in the boundary of the chain."""
    return int((2 * facts.n_forward != facts.n_faces).sum()), NOT_MEASURED


@defect(VOLUME, "1 if the normals point inwards, 0 otherwise; the enclosed volume, then negative")
def _signed_volume(facts: SoupFacts) -> Found:
    """Measure the enclosed volume."""
    return int(facts.signed_volume < 0), facts.signed_volume


def _chosen(facts: SoupFacts, is_chosen: BoolArray) -> Found:
    """Return the number and total length of the chosen edges."""
    return int(is_chosen.sum()), float(facts.edge_lengths[is_chosen].sum())


#: All kinds of defect of a soup, in the order of the table.
SOUP_DEFECTS = (
    _triangles,
    _parts,
    _shells,
    _boundary_edges,
    _non_manifold_edges,
    _non_manifold_vertices,
    _inconsistent_edges,
    _duplicate_triangles,
    _degenerate_triangles,
    _self_intersecting_triangles,
    _unbalanced_edges,
    _signed_volume,
)
