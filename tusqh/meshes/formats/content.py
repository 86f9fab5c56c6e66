"""What every writer gets: nodes, elements and named sets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from tusqh.grid import FloatArray, IntArray
from tusqh.meshes.elements import Element
from tusqh.meshes.quadratic import Nodes
from tusqh.meshes.sets import ElementSet, FacetSet, NamedSets
from tusqh.meshes.volume_mesh import VolumeMesh


class NodeSet(NamedTuple):
    """A named set of nodes.

    Parameters
    ----------
    number
        Number of the set in files, from 1.
    name, meaning
        Name of the set, and what is in it.
    nodes
        Its nodes, ascending, shape (r,).
    """

    number: int
    name: str
    meaning: str
    nodes: IntArray


@dataclass(frozen=True)
class Content:
    """The content of a file.

    Parameters
    ----------
    mesh
        The mesh.
    sets
        Its named sets.
    element
        The kind of its elements.
    nodes
        Its nodes, with those in the middle of edges if the elements are quadratic.
    """

    mesh: VolumeMesh
    sets: NamedSets
    element: Element
    nodes: Nodes

    @property
    def dim(self) -> int:
        """Dimension of the mesh."""
        return self.mesh.dim

    def points_in_space(self) -> FloatArray:
        """Return all nodes with three coordinates, shape (n, 3); in the plane z is 0."""
        points = np.zeros((len(self.nodes.points), 3))
        points[:, : self.dim] = self.nodes.points
        return points

    def cells_of(self, block: ElementSet) -> IntArray:
        """Return the nodes of the elements of a set, shape (r, k).

        Parameters
        ----------
        block
            The set.
        """
        return np.asarray(self.nodes.cells[block.elements], dtype=np.int64)

    def facets_of(self, found: FacetSet) -> IntArray:
        """Return the nodes of the facets of a set: corners, then middle nodes, shape (r, k).

        Parameters
        ----------
        found
            The set.
        """
        local = self.element.facets[found.local]
        cells = self.nodes.cells[found.element]
        return np.asarray(np.take_along_axis(cells, local, axis=1), dtype=np.int64)

    @property
    def node_sets(self) -> list[NodeSet]:
        """The nodes of every set of facets, and those where three regions meet."""
        sets = [
            NodeSet(f.number, f.name, f"points of {f.name}", np.unique(self.facets_of(f)))
            for f in self.sets.facets
        ]
        first = max((found.number for found in sets), default=0)
        return sets + [
            NodeSet(first + p.number, p.name, "points where three meet", p.points)
            for p in self.sets.points
        ]

    def facets_once(self) -> tuple[IntArray, IntArray]:
        """Return the nodes of all facets that are in a set, each once, and its set's number.

        Returns
        -------
        nodes
            Corners, then middle nodes, shape (r, k).
        number
            Number of the set of each, shape (r,).
        """
        sets = self.sets.once
        number = np.repeat([found.number for found in sets], [len(f.element) for f in sets])
        return np.concatenate([self.facets_of(f) for f in sets]), number.astype(np.int64)
