"""The regions of a mesh: the material of every element, and its name in files."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from tusqh.grid import IntArray


class Region(NamedTuple):
    """A region that has elements.

    Parameters
    ----------
    number
        Number of the region in files, from 1.
    name
        Name of the region in files, which consists of letters, digits and underscores.
    elements
        Elements of the region, ascending, shape (r,).
    """

    number: int
    name: str
    elements: IntArray


@dataclass(frozen=True)
class Regions:
    """The material of every element.

    Parameters
    ----------
    names
        Names of all materials.
    material
        Index into `names` for every element, shape (m,).
    """

    names: tuple[str, ...]
    material: IntArray

    @classmethod
    def single(cls, n_elements: int) -> Regions:
        """Return the regions of a mesh of one material.

        Parameters
        ----------
        n_elements
            Number of elements.
        """
        return cls(("solid",), np.zeros(n_elements, dtype=np.int64))

    @cached_property
    def present(self) -> list[Region]:
        """The materials that have elements.

        Examples
        --------
        >>> regions = Regions(("ring 1", "ring.1", "ball"), np.array([2, 0, 2, 1]))
        >>> [(r.number, r.name, r.elements.tolist()) for r in regions.present]
        [(1, 'ring_1', [1]), (2, 'ring_1_2', [3]), (3, 'ball', [0, 2])]
        """
        found: list[Region] = []
        for k in np.unique(self.material).tolist():
            name = re.sub(r"\W", "_", self.names[k]) or "region"
            if name in {region.name for region in found}:
                name = f"{name}_{k + 1}"
            found.append(Region(k + 1, name, np.flatnonzero(self.material == k)))
        return found
