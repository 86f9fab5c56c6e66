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

    @property
    def are_several(self) -> bool:
        """Whether these are materials, the last of which is the void, and not a single solid."""
        return len(self.names) > 1

    @cached_property
    def file_names(self) -> tuple[str, ...]:
        """Names in files, which differ and consist of letters, digits and underscores.

        Examples
        --------
        >>> Regions(("ring 1", "ring.1", "void"), np.array([0, 1])).file_names
        ('ring_1', 'ring_1_2', 'void')
        """
        found: dict[str, int] = {}
        for k, name in enumerate(self.names):
            plain = re.sub(r"\W", "_", name) or "region"
            while plain in found:
                plain = f"{plain}_{k + 1}"
            found[plain] = k
        return tuple(found)

    @cached_property
    def present(self) -> list[Region]:
        """The materials that have elements.

        Examples
        --------
        >>> regions = Regions(("ring 1", "ring.1", "ball"), np.array([2, 0, 2, 1]))
        >>> [(r.number, r.name, r.elements.tolist()) for r in regions.present]
        [(1, 'ring_1', [1]), (2, 'ring_1_2', [3]), (3, 'ball', [0, 2])]
        """
        return [
            Region(k + 1, self.file_names[k], np.flatnonzero(self.material == k))
            for k in np.unique(self.material).tolist()
        ]
